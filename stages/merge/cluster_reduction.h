// Merge: clusters of sheets go on collapsing above the bricks, in one streaming pass over nodes in
// Morton order that holds eight siblings a level, and a few bytes for each cluster.
//
// Based on: Schaefer, Ju, Warren, "Manifold Dual Contouring", 2007, as inside a brick
// (stages/build/brick_clusters.h): the same shapes, rules and solver, so the same bits as one large
// brick gives.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "stages/contouring/cluster_sum.h"
#include "stages/contouring/node_shape.h"
#include "stages/contouring/node_solver.h"
#include "storage/types/top_tree.h"

namespace voxweld {

class ClusterReduction {
 public:
  // root: the cube to reduce; what lies in it and is never pushed has no surface. domain_level: of
  // the octree's root; nothing collapses above.
  ClusterReduction(CellKey root, int domain_level, const ContourParameters& parameters);

  // The next node, in Morton order, not overlapping those before. It may be the root.
  void push(CellKey key, const NodeRecord& record);
  // Once, after all.
  ReducedNode finish();
  // Nodes here of which a cluster may become a vertex.
  std::uint64_t collapsed() const { return collapsed_; }

 private:
  struct Child {
    NodeRecord record;
    std::uint32_t first_cluster = 0;  // of tree_
  };
  struct OpenNode {
    CellKey key;
    std::uint32_t first_node = 0, first_leaf = 0;  // of result_: those in this node
    std::array<std::optional<Child>, 8> children;
  };
  // A cluster: of a pushed node or one above.
  struct Cluster {
    std::uint32_t parent = no_cluster;
    std::uint32_t leaf = no_cluster;
  };

  void open_down_to(CellKey parent);
  void close_last();
  void add_child(CellKey key, Child child);
  bool find_shape(const OpenNode& node);
  Child merge(const OpenNode& node);
  void join(const ClusterRecord& cluster, std::uint32_t place, std::uint32_t into, Child& merged);
  void solve(const OpenNode& node, std::uint32_t number, ClusterRecord& cluster);
  void add_leaf(const OpenNode& node, const NodeRecord& record, std::size_t number, Cluster& place);
  void keep(const Child& child);
  void resolve();
  void sort_leaves();
  // f(place in tree_, link) of each cluster that was pushed.
  template <class F>
  void each_link(const F& f);

  CellKey root_;
  int domain_level_;
  Vec3 spacing_;
  NodeSolver solver_;
  ClusterSum sum_;
  ShapeMerger merger_;
  std::array<std::vector<std::int32_t>, 8> euler_;
  std::vector<OpenNode> open_;
  std::vector<Cluster> tree_;
  std::vector<std::uint32_t> first_of_node_;  // of tree_, for each of result_.nodes
  Child whole_;
  ReducedNode result_;
  std::uint64_t collapsed_ = 0;
  SealingLimits sealing_;
};

// Of one shard-sized cube.
struct ShardClusters {
  std::uint64_t code = 0;             // of its lowest finest cell
  const ReducedNode* node = nullptr;  // of its bricks
};
// What lies above these bricks, by the codes of their lowest finest cells, ascending. shards: all that
// they lie in, in Morton order; bricks without a surface are in none of them and are left out. top: of
// the records of these and of all other shards.
AboveBricks bricks_above(std::span<const ShardClusters> shards, const ReducedNode& top,
                         std::span<const std::uint64_t> bricks);

}  // namespace voxweld
