// Finds what intersects in a range of cubes, and changes nothing.
#pragma once

#include "stages/refine/refine_range.h"

namespace voxweld {

struct FoundPairs {
  // Triangles at home in the range that intersect others, ascending. Of a pair of which one leaves its
  // cube only the other one counts: it alone is known in any case, whatever the ranges are.
  std::vector<std::uint32_t> intersecting;
  // Each is counted in one range: where the one that leaves no cube is at home, or that with the lower
  // ids.
  std::uint64_t pairs = 0;
};

// Preconditions: those of refine_range. Exact, and the same whatever the order in the mesh.
FoundPairs find_range_pairs(const RefineMesh& mesh, const CubeLattice& cubes, const CubeRange& own);

// Bytes it takes at most, beside its argument.
std::uint64_t find_pairs_bytes(const MeshSize& all);

}  // namespace voxweld
