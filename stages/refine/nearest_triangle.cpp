#include "stages/refine/nearest_triangle.h"

#include <algorithm>

namespace voxweld {
namespace {

Vec3 offset(const LatticePoint& from, const LatticePoint& to) {
  return {static_cast<double>(to[0] - from[0]), static_cast<double>(to[1] - from[1]),
          static_cast<double>(to[2] - from[2])};
}
Vec3 vector_of(const double (&v)[3]) {
  return {v[0], v[1], v[2]};
}
void put(Vec3 v, double (&out)[3]) {
  for (int a = 0; a < 3; ++a) out[a] = v[a];
}

}  // namespace

MeasuredTriangle::MeasuredTriangle(const LatticeTriangle& t) : shape_{} {
  const Vec3 ab = offset(t[0], t[1]), ac = offset(t[0], t[2]), normal = cross(ab, ac);
  put(as_vec3({t[0][0], t[0][1], t[0][2]}), shape_.first);
  put(ab, shape_.ab);
  put(ac, shape_.ac);
  put(normal, shape_.normal);
  shape_.abab = dot(ab, ab);
  shape_.abac = dot(ab, ac);
  shape_.acac = dot(ac, ac);
  shape_.nn = dot(normal, normal);
}

// Ericson, "Real-Time Collision Detection", 2005, section 5.1.5, with the point at the origin.
double MeasuredTriangle::squared_distance(const LatticePoint& point) const {
  const Vec3 ab = vector_of(shape_.ab), ac = vector_of(shape_.ac);
  const Vec3 a = vector_of(shape_.first) - as_vec3({point[0], point[1], point[2]});
  const auto squared = [](Vec3 v) { return dot(v, v); };
  const double d1 = -dot(ab, a), d2 = -dot(ac, a);
  if (d1 <= 0 && d2 <= 0) return squared(a);
  const double d3 = d1 - shape_.abab, d4 = d2 - shape_.abac;
  if (d3 >= 0 && d4 <= d3) return squared(a + ab);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return squared(a + ab * (d1 / (d1 - d3)));
  const double d5 = d1 - shape_.abac, d6 = d2 - shape_.acac;
  if (d6 >= 0 && d5 <= d6) return squared(a + ac);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return squared(a + ac * (d2 / (d2 - d6)));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return squared(a + ab + (ac - ab) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))));
  const double height = dot(vector_of(shape_.normal), a);
  return height * height / shape_.nn;
}

double squared_distance(const LatticePoint& point, const LatticeTriangle& triangle) {
  return MeasuredTriangle(triangle).squared_distance(point);
}

void NearestTriangles::add(const LatticeTriangle& shape, const MaterialPair& sides) {
  shapes_.push_back(MeasuredTriangle(shape).shape());
  shapes_.back().sides = number_of(sides);
  if (shapes_.back().sides == static_cast<double>(sides_.size())) sides_.push_back(sides);
}

double NearestTriangles::number_of(const MaterialPair& sides) const {
  return static_cast<double>(std::ranges::find(sides_, sides) - sides_.begin());
}

void NearestTriangles::ask(const LatticePoint& point, const MaterialPair& sides) {
  for (std::size_t a = 0; a < 3; ++a) asked_.at[a][points_] = point[a];
  asked_.sides[points_++] = number_of(sides);
}

const NearestLanes& NearestTriangles::answer() {
  kernel_(shapes_.data(), shapes_.size(), asked_, found_);
  points_ = 0;
  return found_;
}

}  // namespace voxweld
