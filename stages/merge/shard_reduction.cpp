#include "stages/merge/shard_reduction.h"

#include <algorithm>
#include <utility>

namespace voxweld {

void add_brick(BrickCounts& sum, const BrickCounts& brick, NodeState root) {
  if (root != NodeState::leaf) return add(sum, brick);
  sum.active_cells += brick.active_cells;
  sum.crossing_edges += brick.crossing_edges;
}

void FinalLeaves::leaf(CellKey key, const RootRecord& record) {
  ++counts_.vertices;
  ++counts_.by_level.leaves[static_cast<std::size_t>(key.level)];
  counts_.by_level.note_error(key.level, record.residual);
  if (key.level > brick_level_)
    above({key.code(), static_cast<std::uint32_t>(key.level), record.vertex, record.residual, 0});
}

CubeReduction::CubeReduction(const BrickGrid& grid, CellKey cube,
                             const ContourParameters& parameters)
    : FinalLeaves(grid, cube, parameters) {
  node_.key = cube;
}

void CubeReduction::add(const CellKey& brick, const RootRecord& root, std::uint64_t polygons,
                        std::span<const FilledBlock> blocks) {
  reduction().push({brick, root, root.state == NodeState::leaf ? polygons : 0});
  if (root.state != NodeState::split) return;
  for (const FilledBlock& block : blocks)
    cube({brick.code() + (std::uint64_t{block.block} << (3 * block_level)), block_level,
          block.vertices, block.polygons});
}

void FinalLeaves::add(const LeafCounts& counts) {
  voxweld::add(counts_.by_level, counts);
  for (const std::uint64_t leaves : counts.leaves) counts_.vertices += leaves;
}

void CubeReduction::add_record(const CellKey& brick, const NodeRecord& record) {
  clusters()->push(brick, record);
}

ShardNode CubeReduction::finish() {
  if (clusters() != nullptr) {
    node_.clusters = clusters()->finish();
    FinalLeaves::add(node_.clusters.counts);
  }
  const NodeSummary reduced = reduction().finish();
  node_.record = reduced.record;
  node_.polygons = reduced.polygons;
  return std::move(node_);
}

TopReduction::TopReduction(const BrickGrid& grid, const ContourParameters& parameters,
                           std::uint64_t tile_vertices, TopSink& sink)
    : FinalLeaves(grid, {std::max(grid.domain_level(), grid.shard_level()), {}}, parameters),
      sink_(sink),
      planner_(std::max(grid.domain_level(), block_level), tile_vertices,
               [&sink](const PlannedTile& tile) { sink.tile(tile); }) {}

void TopReduction::add(const ShardNode& node) {
  reduction().push({node.key, node.record, node.polygons});
  if (clusters() != nullptr && node.clusters.record.has_surface())
    clusters()->push(node.key, node.clusters.record);
  for (const TopLeaf& leaf : node.leaves) sink_.leaf(leaf, true);
  for (const CubeCount& count : node.cubes) planner_.push(count);
}

void TopReduction::finish() {
  if (clusters() != nullptr) {
    reduced_ = clusters()->finish();
    FinalLeaves::add(reduced_.counts);
    for (const ClusterRecord& cluster : reduced_.record.clusters) FinalLeaves::add(cluster.leaves);
  }
  OctreeReduction::settle(reduction().finish(), *this);
  planner_.finish();
}

}  // namespace voxweld
