// Lengths, and rotation matrices as three rows, so that M p is the rows dotted with p.
#pragma once

#include <array>
#include <cmath>

#include "storage/types/box.h"

namespace voxweld {

inline double length(Vec3 v) {
  return std::sqrt(dot(v, v));
}

using Rows = std::array<Vec3, 3>;

inline Vec3 apply(const Rows& m, Vec3 p) {
  return {dot(m[0], p), dot(m[1], p), dot(m[2], p)};
}
// M^T p: the inverse of a rotation.
inline Vec3 apply_transposed(const Rows& m, Vec3 p) {
  return m[0] * p.x + m[1] * p.y + m[2] * p.z;
}

inline Rows multiply(const Rows& a, const Rows& b) {
  Rows product;
  for (std::size_t i = 0; i < 3; ++i) product[i] = apply_transposed(b, a[i]);
  return product;
}

inline Rows rotation_x(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {Vec3{1, 0, 0}, Vec3{0, c, -s}, Vec3{0, s, c}};
}
inline Rows rotation_y(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {Vec3{c, 0, s}, Vec3{0, 1, 0}, Vec3{-s, 0, c}};
}
inline Rows rotation_z(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {Vec3{c, -s, 0}, Vec3{s, c, 0}, Vec3{0, 0, 1}};
}

}  // namespace voxweld
