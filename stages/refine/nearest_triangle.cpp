#include "stages/refine/nearest_triangle.h"

#include <algorithm>
#include <limits>

namespace voxweld {
namespace {

Vec3 offset(const LatticePoint& from, const LatticePoint& to) {
  return {static_cast<double>(to[0] - from[0]), static_cast<double>(to[1] - from[1]),
          static_cast<double>(to[2] - from[2])};
}

// Squared distance of the origin of the triangle's corners, given relative to the point (Ericson,
// "Real-Time Collision Detection", 2005, section 5.1.5).
double squared_from_origin(Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 ab = b - a, ac = c - a;
  const auto squared = [](Vec3 v) { return dot(v, v); };
  const double d1 = -dot(ab, a), d2 = -dot(ac, a);
  if (d1 <= 0 && d2 <= 0) return squared(a);
  const double d3 = -dot(ab, b), d4 = -dot(ac, b);
  if (d3 >= 0 && d4 <= d3) return squared(b);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return squared(a + ab * (d1 / (d1 - d3)));
  const double d5 = -dot(ab, c), d6 = -dot(ac, c);
  if (d6 >= 0 && d5 <= d6) return squared(c);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return squared(a + ac * (d2 / (d2 - d6)));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return squared(b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))));
  const Vec3 n = cross(ab, ac);
  const double height = dot(n, a);
  return height * height / dot(n, n);
}

double squared_to_box(const LatticePoint& point, const LatticeBox& box) {
  double sum = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::int32_t out = std::max({box.lo[a] - point[a], point[a] - box.hi[a], 0});
    sum += static_cast<double>(out) * out;
  }
  return sum;
}

// A distance to a triangle that was rounded may be less than the exact one to its box, by this part
// of it at most.
constexpr double rounding = 1e-9;

}  // namespace

double squared_distance(const LatticePoint& point, const LatticeTriangle& t) {
  return squared_from_origin(offset(point, t[0]), offset(point, t[1]), offset(point, t[2]));
}

Nearest NearestTriangles::to(const LatticePoint& point, const MaterialPair& sides,
                             std::size_t guess) const {
  Nearest best{std::numeric_limits<double>::infinity(), 0};
  double most = best.squared;
  const auto look = [&](std::size_t i) {
    const double d = squared_distance(point, triangles_[i].shape);
    if (d > best.squared || (d == best.squared && i > best.triangle)) return;
    best = {d, i};
    most = d * (1 + rounding);
  };
  if (guess < triangles_.size() && triangles_[guess].sides == sides) look(guess);
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    const Triangle& t = triangles_[i];
    if (i != guess && t.sides == sides && squared_to_box(point, t.box) <= most) look(i);
  }
  return best;
}

}  // namespace voxweld
