// One tile's mesh from the pieces of its surface's octree, wherever they are.
#pragma once

#include <functional>

#include "stages/stitch/tile_stitcher.h"

namespace voxweld {

// The brick one further on each axis whose bit is set in `direction` (1 .. 7).
constexpr Index3 upper_neighbour(Index3 brick, int direction) {
  return brick + Index3{direction & 1, direction >> 1 & 1, direction >> 2};
}

// The octree of one surface, brick by brick, as build_brick leaves it.
class BrickPieces {
 public:
  virtual ~BrickPieces() = default;
  // Needs no root and no counts. Lives until the next call.
  virtual const BrickOctree& brick(const CellKey& key) = 0;
  // Null where the brick has no surface, or is none. Lives until the next brick is asked for, or
  // the next ghost layer in the same direction.
  virtual const GhostLayer* ghost(Index3 brick, int direction) = 0;
};

// The codes of the lowest finest cells of the bricks and their upper neighbours, ascending.
std::vector<std::uint64_t> codes_read(std::span<const CellKey> bricks);

// Those of `leaves` that the bricks and their upper neighbours lie in, ascending. Their Morton
// range is not one interval, so they are looked up brick by brick. leaves(begin, end): those that
// meet the range of codes, ascending.
using LeafLookup = std::function<std::vector<TopLeaf>(std::uint64_t begin, std::uint64_t end)>;
std::vector<TopLeaf> leaves_above(std::span<const CellKey> bricks, const LeafLookup& leaves);

// bricks: those with a surface that the tile meets, in Morton order; above: leaves_above, or more.
TileMesh stitch_tile(const PlannedTile& tile, const StitchParameters& parameters,
                     std::span<const CellKey> bricks, std::span<const TopLeaf> above,
                     BrickPieces& pieces);
// Where each sheet collapses by itself. above: of the bricks and their upper neighbours, or more.
TileMesh stitch_tile(const PlannedTile& tile, const StitchParameters& parameters,
                     std::span<const CellKey> bricks, const AboveBricks& above,
                     BrickPieces& pieces);

}  // namespace voxweld
