// The directions a vertex's Hermite normals fall into. A smooth surface has one; a crease has one
// for each side, so that shading stays sharp there. Defined over the octree (children in Morton
// order), hence the same however the volume is cut into bricks.
#pragma once

#include <span>

#include "storage/types/brick_octree.h"

namespace voxweld {

// Directions within this angle of each other's mean are one cluster (cosine of 25 degrees: a crease
// of 50 or more stays sharp).
inline constexpr float cluster_cosine = 0.906f;

using NormalSum = std::array<float, 3>;

// Groups sums of unit normals: one cluster when all lie near their total; else in order, each
// joining the nearest cluster, or opening a new one while there is room.
NormalClusters cluster_normals(std::span<const NormalSum> sums);

// A node's clusters from those of its children, given in octant order.
class ClusterMerge {
 public:
  void add(const NormalClusters& child) {
    for (const NormalSum& sum : child.sum)
      if (sum != NormalSum{}) sums_[count_++] = sum;
  }
  NormalClusters merged() const { return cluster_normals({sums_.data(), count_}); }

 private:
  std::array<NormalSum, std::size_t{8} * max_clusters> sums_{};
  std::size_t count_ = 0;
};

// Unit directions for storing; no_normal for unused clusters.
std::array<PackedNormal, max_clusters> pack_clusters(const NormalClusters& clusters);

// The cluster whose direction is nearest to `direction` (need not be unit); ties: the lower.
int nearest_cluster(const std::array<PackedNormal, max_clusters>& normals, Vec3 direction);

}  // namespace voxweld
