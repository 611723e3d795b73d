// Whether two triangles have something in common, behind tests of planes that spare nearly all of them
// an exact look: mostly one has all corners on one side of the other's plane.
#pragma once

#include "stages/exact/orientation.h"
#include "stages/exact/triangle_pair.h"

namespace voxweld {

// Of arrays of this size compilers make a call of a function.
inline bool same_place(const LatticePoint& p, const LatticePoint& q) {
  return ((p[0] ^ q[0]) | (p[1] ^ q[1]) | (p[2] ^ q[2])) == 0;
}
inline bool is_corner(const LatticePoint& p, const LatticeTriangle& t) {
  return same_place(p, t[0]) || same_place(p, t[1]) || same_place(p, t[2]);
}

// All of b strictly on one side of a's plane. normal: exact_normal of a, here and below.
inline bool on_one_side(const LatticeTriangle& a, const Index3& normal, const LatticeTriangle& b) {
  const int side = sign_of_dot(normal, lattice_vector(a[0], b[0]));
  return side != 0 && sign_of_dot(normal, lattice_vector(a[0], b[1])) == side &&
         sign_of_dot(normal, lattice_vector(a[0], b[2])) == side;
}

// All corners of b that are none of a strictly on one side of a's plane: then the two have nothing in
// common but what they share.
inline bool leaves_plane(const LatticeTriangle& a, const Index3& normal, const LatticeTriangle& b) {
  int side = 0;
  for (const LatticePoint& p : b) {
    if (is_corner(p, a)) continue;
    const int here = sign_of_dot(normal, lattice_vector(a[0], p));
    if (here == 0 || here == -side) return false;
    side = here;
  }
  return side != 0;
}

// intersect_beyond_shared() of triangles that share a vertex.
inline bool intersect_by_planes(const LatticeTriangle& a, const Index3& normal_a,
                                const LatticeTriangle& b, const Index3& normal_b) {
  return !leaves_plane(a, normal_a, b) && !leaves_plane(b, normal_b, a) &&
         intersect_beyond_shared(a, b);
}

// Whether triangles that share no vertex have nothing in common, not even a place.
inline bool lie_apart(const LatticeTriangle& a, const Index3& normal_a, const LatticeTriangle& b,
                      const Index3& normal_b) {
  if (on_one_side(b, normal_b, a) || on_one_side(a, normal_a, b)) return true;
  const bool share_a_place = is_corner(a[0], b) || is_corner(a[1], b) || is_corner(a[2], b);
  return !share_a_place && !intersect_beyond_shared(a, b);
}

}  // namespace voxweld
