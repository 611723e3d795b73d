// What lies above the bricks: leaves that took in whole bricks, and the cubes tiles are cut from.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "storage/types/brick_octree.h"

namespace voxweld {

// A leaf above the bricks. Ascending `code` in every list.
struct TopLeaf {
  std::uint64_t code = 0;  // Morton code of its lowest finest cell
  std::uint32_t level = 0;
  LeafVertex vertex;  // leaf code unused; offset from the leaf's centre
  float residual = 0;
  std::uint32_t reserved = 0;  // no padding: leaves are written as they lie in memory

  constexpr CellKey key() const { return CellKey::of(code, level); }
};

// Where each sheet collapses by itself: what lies above some bricks.
struct BrickAbove {
  std::uint64_t code = 0;        // of the brick's lowest finest cell
  std::uint32_t first_link = 0;  // of AboveBricks::links: one for each cluster of its record
  std::uint32_t covered = 0;  // 1: the node of a vertex above holds the brick, even if none of its
                              // clusters is of that vertex
};
struct AboveBricks {
  std::vector<BrickAbove> bricks;    // ascending code
  std::vector<std::uint32_t> links;  // in `leaves`: the vertex that has taken the cluster in, or
                                     // no_cluster
  std::vector<ClusterLeaf> leaves;  // by the code of their node, then level, then first sheet; of a
                                    // node all

  // Null where nothing is above: the brick stays as it is.
  const BrickAbove* find(std::uint64_t code) const {
    const auto at =
        std::lower_bound(bricks.begin(), bricks.end(), code,
                         [](const BrickAbove& brick, std::uint64_t c) { return brick.code < c; });
    return at == bricks.end() || at->code != code ? nullptr : &*at;
  }
};

// Where each sheet collapses by itself: a node put together from smaller ones.
//
// Where a cluster of one of these went.
struct ClusterLink {
  std::uint32_t leaf = no_cluster;  // in ReducedNode::leaves: the highest that has taken it in
  std::uint32_t root = no_cluster;  // in ReducedNode::record.clusters: what may yet take it in
};
// One of them. Those without a cluster on their border are there too.
struct LinkedNode {
  std::uint64_t code = 0;        // CellKey::code
  std::uint32_t first_link = 0;  // one for each of its clusters
  std::uint32_t covered = 0;     // 1: the node of a leaf holds it, which need not hold its clusters
};
struct ReducedNode {
  NodeRecord record;                // of the whole
  std::vector<ClusterLeaf> leaves;  // by the code of their node, then level, then first sheet
  std::vector<LinkedNode> nodes;    // in Morton order
  std::vector<ClusterLink> links;
  LeafCounts counts;  // of what no node above can take in

  // Of nodes[n]'s: behind the last.
  std::size_t end_of_links(std::size_t n) const {
    return n + 1 < nodes.size() ? nodes[n + 1].first_link : links.size();
  }
};

// Vertices and polygons of one cube, a 16^3 block or larger. Vertices count where their leaf's
// lowest cell lies, polygons where their owner cell does.
struct CubeCount {
  std::uint64_t code = 0;  // Morton code of its lowest finest cell
  std::uint32_t level = 0;
  std::uint32_t vertices = 0;
  std::uint64_t polygons = 0;
};

// One shard-sized cube of the octree. A shard at the volume's upper border also builds the layer of
// bricks above it when that holds nothing but ring cells: such bricks lie in cubes of their own.
struct ShardNode {
  CellKey key;
  RootRecord record;
  std::uint64_t polygons = 0;    // when the whole cube is one leaf
  std::vector<CubeCount> cubes;  // final ones, in Morton order
  std::vector<TopLeaf> leaves;   // final ones above the bricks, in Morton order
  ReducedNode clusters;          // of the bricks, where each sheet collapses by itself
};

// One tile of the plan.
struct PlannedTile {
  std::uint64_t code = 0;
  std::uint32_t level = 0;
  std::uint32_t reserved = 0;
  std::uint64_t vertices = 0;
  std::uint64_t polygons = 0;  // before those of fewer than three leaves are dropped

  constexpr CellKey key() const { return CellKey::of(code, level); }
};

}  // namespace voxweld
