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

// Cubes of the octree's domain.
struct CubeGrid {
  int level = refine_cube_level;  // log2 of the cells a side of one
  std::int64_t side = 0;          // how many a side; 0: what lies beyond tiles begins no range
  Index3 size{};                  // cells of the volume, which may be far less; 0: it is not known
};

CubeGrid cubes_of(const RefineFrame& frame);

// Each tile's cube, at least one cube of refine large, begins a range that ends where the next
// begins: so every cube of space is in one of them. Fewer tiles than `enough` are cut up,
// so that several processors share them; what of them lies beyond the volume begins none. A tile of
// several cubes is cut up too where it would have more to do in the second pass than any has in the
// first. Cubes of that pass lie beyond the tiles too, half a side further up: all of them may come
// behind the same tile, as where a full volume ends at a power of two. Ranges begin there as well, so
// that none has more of them than the fullest tile. Empty where there are no tiles.
// tiles: in Morton order.
std::vector<PlannedRange> cube_ranges(std::span<const PlannedTile> tiles, std::size_t enough = 32,
                                      const CubeGrid& cubes = {});

}  // namespace voxweld
