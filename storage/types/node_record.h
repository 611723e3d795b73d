// What an octree node leaves for those above, so that they can go on collapsing without its cells:
// build writes one for each brick and each shard, merge reads them.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "storage/types/face_curve.h"
#include "storage/types/leaf_vertex.h"
#include "storage/types/morton.h"

namespace voxweld {

// The vertices that remain, by the level of their nodes.
struct LeafCounts {
  std::array<std::uint64_t, max_levels + 1> leaves{};
  // The largest of each level. What the samples alone bound at level 0, and the tolerance above.
  std::array<float, max_levels + 1> errors{};

  void note_error(int level, float error) {
    float& largest = errors[static_cast<std::size_t>(level)];
    largest = std::max(largest, error);
  }
  // Up to the last that has any, one at least.
  std::size_t levels() const {
    std::size_t count = leaves.size();
    while (count > 1 && leaves[count - 1] == 0) --count;
    return count;
  }
  // Of these.
  std::span<const std::uint64_t> used_leaves() const { return std::span(leaves).first(levels()); }
  std::span<const float> used_errors() const { return std::span(errors).first(levels()); }
  float worst_collapsed() const { return *std::max_element(errors.begin() + 1, errors.end()); }
};
inline void add(LeafCounts& sum, const LeafCounts& part) {
  for (std::size_t l = 0; l < sum.leaves.size(); ++l) {
    sum.leaves[l] += part.leaves[l];
    sum.errors[l] = std::max(sum.errors[l], part.errors[l]);
  }
}

// The first finest cell of a cluster, by its Morton code in the volume, and the sheet there. With
// the node's level it names the cluster, in every partition.
struct FirstSheet {
  std::uint64_t bits = ~std::uint64_t{0};  // later than all
  static constexpr FirstSheet make(std::uint64_t code, int sheet) {
    return {code << 2 | static_cast<std::uint64_t>(sheet)};
  }
  constexpr std::uint64_t code() const { return bits >> 2; }
  constexpr int sheet() const { return static_cast<int>(bits & 3); }
  friend constexpr auto operator<=>(FirstSheet, FirstSheet) = default;
};

struct ClusterRecord {
  Qef qef;
  NormalClusters normals;
  std::array<float, 3> offset{};  // of its vertex, where it collapses: from the node's centre
  float residual = 0;
  FirstSheet first;
  std::int32_t euler = 1;
  std::uint32_t collapses = 0;  // 1: within the tolerance it may
  LeafCounts leaves;            // of its own, unless it becomes part of one above

  // Whether it may at some tolerance: what the rules keep apart has no residual.
  bool may_collapse() const { return collapses != 0 || residual > 0; }
};

struct NodeRecord {
  bool blocked = false;  // no cluster is known: what there is stays as it is, here and above
  bool closes = false;   // some components of the surface lie in the node as a whole
  std::vector<ClusterRecord> clusters;  // those that meet the node's border, ascending `first`
  std::vector<FaceCurve> curves;        // as NodeShape has them
  std::vector<CurvePair> pairs;
  // Else there is no surface in the node.
  bool has_surface() const { return blocked || closes || !clusters.empty(); }
  // Whether all sheets in the node are of one cluster.
  bool is_one() const { return !blocked && !closes && clusters.size() == 1; }
};

// A vertex of a node above the bricks.
struct ClusterLeaf {
  FirstSheet first;
  std::uint32_t level = 0;
  std::uint32_t shares = 0;  // 1: other vertices may lie in its node
  LeafVertex vertex;         // leaf code: the sense of its normals alone
  float residual = 0;

  constexpr CellKey key() const {
    return CellKey::of(first.code(), static_cast<std::uint64_t>(level));
  }
};

}  // namespace voxweld
