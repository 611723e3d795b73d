#include "stages/stitch/quad_split.h"

#include <algorithm>
#include <cmath>

namespace voxweld {
namespace {

// Differences have 23 bits, their products 46: every component is exact in a double.
Vec3 difference(const LatticePoint& a, const LatticePoint& b) {
  return {static_cast<double>(b[0] - a[0]), static_cast<double>(b[1] - a[1]),
          static_cast<double>(b[2] - a[2])};
}

// Cosine between the two triangles' normals; below any cosine when one has no area.
double flatness(const Vec3& u, const Vec3& v) {
  const double uu = dot(u, u), vv = dot(v, v);
  if (uu == 0 || vv == 0) return -2;
  return dot(u, v) / std::sqrt(uu * vv);
}

double length2(const QuadCorner& a, const QuadCorner& b) {
  const Vec3 d = difference(a.point, b.point);
  return dot(d, d);
}

}  // namespace

Vec3 area_vector(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c) {
  return cross(difference(a, b), difference(a, c));
}

bool cut_from_one(const std::array<QuadCorner, 4>& q) {
  const auto area = [&](std::size_t a, std::size_t b, std::size_t c) {
    return area_vector(q[a].point, q[b].point, q[c].point);
  };
  const double zero = flatness(area(0, 1, 2), area(0, 2, 3));
  const double one = flatness(area(1, 2, 3), area(1, 3, 0));
  if (zero != one) return one > zero;
  const double zero_length = length2(q[0], q[2]), one_length = length2(q[1], q[3]);
  if (zero_length != one_length) return one_length < zero_length;
  return std::min(q[1].id, q[3].id) < std::min(q[0].id, q[2].id);
}

}  // namespace voxweld
