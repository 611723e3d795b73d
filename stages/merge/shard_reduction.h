// The octree put together from its bricks in two passes: what build leaves of each shard-sized
// cube, and what merge makes of all cubes. Both reduce (octree_reduction.h), count the leaves that
// no node above takes in, and hand on those that lie above the bricks.
#pragma once

#include "stages/contouring/brick_grid.h"
#include "stages/contouring/parameters.h"
#include "stages/merge/cluster_reduction.h"
#include "stages/merge/octree_reduction.h"
#include "stages/merge/tile_planner.h"

namespace voxweld {

// A brick's figures to those of all. Its leaves are its own unless it is one: then the reduction
// says where that ends.
void add_brick(BrickCounts& sum, const BrickCounts& brick, NodeState root);

// Counts what is final; passes on leaves above the bricks as they are kept.
class FinalLeaves : protected ReductionSink {
 public:
  // vertices and by_level, of the leaves the reduction found final.
  const BrickCounts& counts() const { return counts_; }
  // Nodes that took in their children.
  std::uint64_t collapsed() const {
    return clusters_ ? clusters_->collapsed() : reduction_.collapsed();
  }

 protected:
  FinalLeaves(const BrickGrid& grid, CellKey root, const ContourParameters& parameters)
      : brick_level_(grid.brick_level()), reduction_(root, grid.domain_level(), parameters, *this) {
    if (collapses_by_sheets(parameters)) clusters_.emplace(root, grid.domain_level(), parameters);
  }
  OctreeReduction& reduction() { return reduction_; }
  // Null unless each sheet collapses by itself. Then the other finds every node split.
  ClusterReduction* clusters() { return clusters_ ? &*clusters_ : nullptr; }
  void add(const LeafCounts& counts);

 private:
  void leaf(CellKey key, const RootRecord& record) final;
  virtual void above(const TopLeaf& leaf) = 0;

  int brick_level_;
  BrickCounts counts_;
  OctreeReduction reduction_;
  std::optional<ClusterReduction> clusters_;
};

// The bricks of one cube to its node.
class CubeReduction final : private FinalLeaves {
 public:
  // cube: one of grid.shard_cubes().
  CubeReduction(const BrickGrid& grid, CellKey cube, const ContourParameters& parameters);

  // In Morton order; bricks that are never added are outside. polygons are looked at where the brick
  // is one leaf, blocks where it is split.
  void add(const CellKey& brick, const RootRecord& root, std::uint64_t polygons,
           std::span<const FilledBlock> blocks);
  // Besides, where each sheet collapses by itself.
  void add_record(const CellKey& brick, const NodeRecord& record);
  ShardNode finish();

  using FinalLeaves::collapsed;
  using FinalLeaves::counts;

 private:
  void above(const TopLeaf& leaf) override { node_.leaves.push_back(leaf); }
  void cube(const CubeCount& count) override { node_.cubes.push_back(count); }

  ShardNode node_;
};

// Takes what merge makes, in Morton order each.
class TopSink {
 public:
  virtual ~TopSink() = default;
  // known: a node of the shards has it already.
  virtual void leaf(const TopLeaf& leaf, bool known) = 0;
  virtual void tile(const PlannedTile& tile) = 0;
};

// All cubes' nodes to the leaves above the bricks and the plan of the tiles.
class TopReduction final : private FinalLeaves {
 public:
  // tile_vertices: as TilePlanner. sink: outlives it.
  TopReduction(const BrickGrid& grid, const ContourParameters& parameters,
               std::uint64_t tile_vertices, TopSink& sink);

  void add(const ShardNode& node);  // in Morton order
  void finish();
  // Of the shards whose record has clusters or is blocked, where each sheet collapses by itself.
  const ReducedNode& reduced() const { return reduced_; }

  using FinalLeaves::collapsed;
  using FinalLeaves::counts;

 private:
  void above(const TopLeaf& leaf) override { sink_.leaf(leaf, false); }
  void cube(const CubeCount& count) override { planner_.push(count); }

  TopSink& sink_;
  TilePlanner planner_;
  ReducedNode reduced_;
};

}  // namespace voxweld
