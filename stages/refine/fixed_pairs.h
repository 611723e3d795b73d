// Pairs that intersect of triangles that no cube may change in this pass.
#pragma once

#include "storage/types/refine_mesh.h"

namespace voxweld {

// A triangle that is fixed in this pass.
struct FixedTriangle {
  std::uint32_t triangle = 0;
  // It lies within one cube, but not within one of the parts that the cube was cut into.
  bool within = false;
  bool own = false;  // it is at home in the range at hand
};

struct FixedPairs {
  std::vector<std::uint32_t> intersecting;  // own ones, ascending
  // Each is counted in one range: where the one within a cube is at home, else where the one with the
  // lower ids is.
  std::uint64_t pairs = 0;
};

// Where mesh.checked, of what it lists as intersecting alone.
FixedPairs find_fixed_pairs(const RefineMesh& mesh, const std::vector<FixedTriangle>& fixed);

}  // namespace voxweld
