// From a brick's active cells and their Hermite data on: its octree, polygons, ghost layer and root.
#pragma once

#include "stages/build/brick_leaves.h"

namespace voxweld {

// Reused from brick to brick.
struct CellOctreeScratch {
  BrickNodes nodes;
  BrickLeaves leaves;
  std::vector<std::uint32_t> marks;
};

// volume_size: samples a side. Appends to `out`, whose blocks are there and zero, and whose other
// parts are empty. Precondition: there is a cell.
void build_octree(const BrickFrame& frame, Index3 volume_size, const SignGrid& signs,
                  const ActiveCells& cells, const HermiteEdges& edges,
                  const ContourParameters& parameters, CellOctreeScratch& scratch,
                  BrickOctree& out);
// Between labels.
void build_octree(const BrickFrame& frame, Index3 volume_size, const LabelGrid& labels,
                  const ActiveCells& cells, const HermiteEdges& edges,
                  const ContourParameters& parameters, CellOctreeScratch& scratch,
                  BrickOctree& out);

}  // namespace voxweld
