// The directions a vertex's Hermite normals fall into. A smooth surface has one; a crease has one
// for each side, so that shading stays sharp there. Defined over the octree (children in Morton
// order), hence the same however the volume is cut into bricks.
#pragma once

#include <optional>
#include <span>

#include "storage/types/brick_octree.h"

namespace voxweld {

// Directions within this angle of each other's mean are one cluster (cosine of 25 degrees: a crease
// of 50 or more stays sharp).
inline constexpr float cluster_cosine = 0.906f;

using NormalSum = std::array<float, 3>;

// Groups sums of unit normals: one cluster when all lie near their total; else in order, each
// joining the nearest cluster, or opening a new one while there is room. cosine: of the angle that is
// near. A cluster of either sense
// has that of its first sum.
NormalClusters cluster_normals(std::span<const NormalSum> sums, NormalSense sense,
                               float cosine = cluster_cosine);

// Their total, where all of them are near it.
std::optional<NormalSum> one_direction(std::span<const NormalSum> sums, NormalSense sense,
                                       float cosine = cluster_cosine);

// A node's clusters from those of its children, given in octant order.
class ClusterMerge {
 public:
  void add(const NormalClusters& child) {
    for (const NormalSum& sum : child.sum)
      if (sum != NormalSum{}) sums_[count_++] = sum;
    if (child.sense == NormalSense::either) sense_ = child.sense;
  }
  NormalClusters merged() const { return cluster_normals({sums_.data(), count_}, sense_); }

 private:
  std::array<NormalSum, std::size_t{8} * max_clusters> sums_{};
  std::size_t count_ = 0;
  NormalSense sense_ = NormalSense::outward;
};

// Unit directions for storing; no_normal for unused clusters.
std::array<PackedNormal, max_clusters> pack_clusters(const NormalClusters& clusters);

// The normal of a triangle's corner: that of the cluster whose direction is nearest to the
// triangle's (need not be unit); ties: the lower. Of either sense, turned to the triangle's side.
CornerNormal nearest_cluster(const std::array<PackedNormal, max_clusters>& normals, Vec3 direction,
                             NormalSense sense);

}  // namespace voxweld
