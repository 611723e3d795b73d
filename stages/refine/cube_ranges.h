// The units of refine: which cubes are done together.
#pragma once

#include <span>
#include <vector>

#include "stages/refine/cube_lattice.h"
#include "storage/types/top_tree.h"

namespace voxweld {

// A range of cubes, and about what of the plan's tiles lies in it.
struct PlannedRange {
  CubeRange cubes;
  std::uint64_t vertices = 0, polygons = 0;
};

// Each tile's cube, at least one cube of refine large, begins a range that ends where the next
// begins: so every cube of space is in one of them. Fewer tiles than `enough` are cut up,
// so that several processors share them. A tile of several cubes is cut up too where it would have more
// to do in the second pass than any has in the first. Empty where there are no tiles.
// tiles: in Morton order. level: of the cubes.
std::vector<PlannedRange> cube_ranges(std::span<const PlannedTile> tiles, std::size_t enough = 32,
                                      int level = refine_cube_level);

}  // namespace voxweld
