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

struct MendRoom {
  // Of the cubes of half the side by which boxes are cut, their CubeLattice's pass.
  int cut = 1;
  // Of how many places boxes are planned together. Where there are more, boxes end where the cubes of
  // this pass do.
  std::uint64_t most_places = std::uint64_t{1} << 18;
  int walls = 0;
  int pass = 1;        // of the cubes by which `around` of places was counted
  double cells = 12;   // around a triangle
  double lengths = 1;  // and so many times as much as it is long
};

// Boxes in the volume's cells that do not meet, ascending by their lower corners, such that each place
// lies in one with room around it. What is changed in one has no part in what is changed in another.
// Boxes that would meet become one. Where that may hold too many triangles, its places get less room;
// and where the least does not help, it is cut by cubes of half the side, and cubes without places are
// left out. So there a place may lie at a border after all. (With cut = 1 these borders lie between those
// of the passes, and those of cut = 0 and 2 lie elsewhere.)
//
// The result does not depend on the order of the places.
std::vector<LatticeBox> mend_boxes(std::vector<IntersectionPlace> places, const RefineFrame& frame,
                                   const MendRoom& room = {});

// The same of places that lie in one of these cubes each, without looking beyond it: boxes end where the
// cubes do. Other places are left out.
std::vector<LatticeBox> mend_boxes_within(const std::vector<IntersectionPlace>& places,
                                          const RefineFrame& frame, const MendRoom& room,
                                          const CubeLattice& cubes);

}  // namespace voxweld
