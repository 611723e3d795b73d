// What one tile's stitching reads: its bricks, their upper neighbours' ghost layers, its part of
// the top tree.
#pragma once

#include "pipeline/stitch/tile_pieces.h"

namespace voxweld {

struct TileInputs {
  // Those with a surface that the tile's cube meets, in Morton order.
  std::vector<CellKey> bricks;
  // What lies above them and their upper neighbours: one of the two, as the job collapses.
  std::vector<TopLeaf> leaves;
  AboveBricks clusters;  // where each sheet collapses by itself
};

// surface, tile: of `top`; clusters: of that surface.
TileInputs tile_inputs(const BuildJob& job, const MaterialTop& top, const SurfaceRecord& surface,
                       const PlannedTile& tile, const ReducedNode& clusters,
                       MaterialPieces& pieces);

// Of all that: what the tile's mesh depends on.
Hash128 tile_key(const StitchJob& job, const PlannedTile& tile, const TileInputs& inputs,
                 MaterialPieces& pieces);

}  // namespace voxweld
