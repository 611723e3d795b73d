// Where mend works: boxes around what still intersects once all cubes are refined.
//
// A cube may not change what lies at its border. A box is put around the very triangles that
// intersect, with room on all sides, so it has no such border there.
#pragma once

#include <vector>

#include "stages/refine/cube_lattice.h"

namespace voxweld {

// A triangle that intersects another.
struct IntersectionPlace {
  LatticeBox box;            // around the triangle
  std::uint64_t around = 0;  // how many triangles are at home in the same cube
};

// Boxes in the volume's cells that do not meet, ascending by their lower corners, such that each place
// lies in one with room around it. What is changed in one has no part in what is changed in another.
// Boxes that would meet become one. Where that may hold too many triangles, its places get less room; and where the
// least does not help, it is cut by cubes of half the side, whose borders lie between those of the
// passes, and cubes without places are left out. So there a place may lie at a border after all.
//
// The result does not depend on the order of the places.
std::vector<LatticeBox> mend_boxes(const std::vector<IntersectionPlace>& places,
                                   const RefineFrame& frame);

}  // namespace voxweld
