// What one tile's stitching reads: its bricks, their upper neighbours' ghost layers, its part of
// the top tree.
#pragma once

#include "pipeline/stitch/stitch_stage.h"
#include "pipeline/stitch/tile_pieces.h"

namespace voxweld {

// The bricks with a surface that a tile's cube meets, in Morton order.
std::vector<CellKey> tile_bricks(const BrickGrid& grid, CellKey tile, MaterialPieces& pieces);

// What lies above them and their upper neighbours: one of the two, as the job collapses.
struct TileAbove {
  std::vector<TopLeaf> leaves;
  AboveBricks clusters;  // where each sheet collapses by itself
};
// The latter: of the bricks' shards and of top.
AboveBricks clusters_above(const BrickGrid& grid, const std::vector<CellKey>& bricks,
                           const ReducedNode& top, const MaterialPieces& pieces);
// clusters: those of `top`.
TileAbove tile_above(const BuildJob& job, const std::vector<CellKey>& bricks,
                     const TopArtifact& top, const ReducedNode& clusters,
                     const MaterialPieces& pieces);

Hash128 tile_key(const StitchJob& job, const PlannedTile& tile, const std::vector<CellKey>& bricks,
                 const TileAbove& above, MaterialPieces& pieces);

// The most bytes the parts of one of these bricks take, its neighbours' ghost layers included.
std::uint64_t largest_brick_bytes(const std::vector<CellKey>& bricks, MaterialPieces& pieces);

}  // namespace voxweld
