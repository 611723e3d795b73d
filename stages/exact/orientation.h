// On which side of a plane or a line a lattice point lies, without rounding.
//
// Coordinates are those of the output lattice, of at most 22 bits. So differences have 23 bits, minors
// of two rows 46 and determinants of three 71: minors are exact in 64 bits, and determinants in 128.
// A determinant in double decides nearly always, behind a bound on its rounding (as in Shewchuk,
// "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997).
#pragma once

#include <cmath>
#include <cstdint>

#include "storage/types/box.h"
#include "storage/types/output_lattice.h"

namespace voxweld {

__extension__ using Int128 = __int128;

constexpr Index3 lattice_vector(const LatticePoint& from, const LatticePoint& to) {
  return {std::int64_t{to[0]} - from[0], std::int64_t{to[1]} - from[1],
          std::int64_t{to[2]} - from[2]};
}

constexpr Index3 exact_cross(Index3 a, Index3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// Twice the area of the triangle, times its unit normal.
constexpr Index3 exact_normal(const LatticePoint& p, const LatticePoint& q, const LatticePoint& r) {
  return exact_cross(lattice_vector(p, q), lattice_vector(p, r));
}

template <class Number>
constexpr int sign_of(Number value) {
  return (value > 0 ? 1 : 0) - (value < 0 ? 1 : 0);
}

// The sign of normal . v, for components of at most 46 and 23 bits.
inline int sign_of_dot(Index3 normal, Index3 v) {
  const double x = static_cast<double>(normal.x) * static_cast<double>(v.x);
  const double y = static_cast<double>(normal.y) * static_cast<double>(v.y);
  const double z = static_cast<double>(normal.z) * static_cast<double>(v.z);
  const double sum = x + y + z;
  // Three products and two sums are each off by half a unit in the last place, which is 2^-53: so the
  // sum by less than four of these, of the largest it could be. Twice that is on the safe side.
  if (std::abs(sum) > 0x1p-50 * (std::abs(x) + std::abs(y) + std::abs(z))) return sign_of(sum);
  return sign_of(static_cast<Int128>(normal.x) * v.x + static_cast<Int128>(normal.y) * v.y +
                 static_cast<Int128>(normal.z) * v.z);
}

// 1 where s lies on the side of the plane through p, q and r from which they run counter-clockwise,
// -1 on the other, 0 in the plane.
inline int orientation(const LatticePoint& p, const LatticePoint& q, const LatticePoint& r,
                       const LatticePoint& s) {
  return sign_of_dot(exact_normal(p, q, r), lattice_vector(p, s));
}

// The same in the plane of two of the axes: 1 where p, q, r run counter-clockwise seen from the tip of
// the axis that is left out.
inline int orientation(const LatticePoint& p, const LatticePoint& q, const LatticePoint& r,
                       int left_out) {
  return sign_of(exact_normal(p, q, r)[left_out]);
}

}  // namespace voxweld
