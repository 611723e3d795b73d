// Whether two triangles of a mesh intersect, exactly.
#pragma once

#include <array>

#include "storage/types/output_lattice.h"

namespace voxweld {

using LatticeTriangle = std::array<LatticePoint, 3>;

// No area: corners that are equal or on one line.
bool has_no_area(const LatticeTriangle& triangle);

// Whether they have more in common than the corners and the edge that they share by position: a
// crossing, a touch, an overlap in one plane, or all three corners. Of a degenerate triangle: false.
// Symmetric, and the same for any order of the corners.
// The triangles are closed sets, as in Guigue and Devillers, "Fast and Robust Triangle-Triangle
// Overlap Test Using Orientation Predicates", 2003; here edges are tested against triangles, for
// which what they share decides what is left to test.
bool intersect_beyond_shared(const LatticeTriangle& a, const LatticeTriangle& b);

}  // namespace voxweld
