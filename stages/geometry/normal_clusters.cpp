#include "stages/geometry/normal_clusters.h"

#include <cmath>

namespace voxweld {
namespace {

float dot3(const NormalSum& a, const NormalSum& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
float length(const NormalSum& a) {
  return std::sqrt(dot3(a, a));
}
void add(NormalSum& to, const NormalSum& what) {
  for (std::size_t i = 0; i < 3; ++i) to[i] += what[i];
}

// Cosine of the angle between two sums, scaled by the length of `a`: enough to compare and avoids
// one division for each pair.
bool near(const NormalSum& a, const NormalSum& b) {
  return dot3(a, b) >= cluster_cosine * length(a) * length(b);
}

}  // namespace

NormalClusters cluster_normals(std::span<const NormalSum> sums) {
  NormalClusters clusters;
  NormalSum total{};
  for (const NormalSum& sum : sums) add(total, sum);
  bool one = length(total) > 0;  // opposite sheets may cancel
  for (const NormalSum& sum : sums) one = one && near(sum, total);
  if (one) {
    clusters.sum[0] = total;
    return clusters;
  }
  std::size_t count = 0;
  for (const NormalSum& sum : sums) {
    std::size_t best = 0;
    float best_cosine = -2;
    for (std::size_t k = 0; k < count; ++k) {
      const float scale = length(clusters.sum[k]);
      const float cosine = scale > 0 ? dot3(clusters.sum[k], sum) / scale : -1.0f;
      if (cosine > best_cosine) {
        best_cosine = cosine;
        best = k;
      }
    }
    if (count < max_clusters && best_cosine < cluster_cosine * length(sum)) best = count++;
    add(clusters.sum[best], sum);
  }
  return clusters;
}

std::array<PackedNormal, max_clusters> pack_clusters(const NormalClusters& clusters) {
  std::array<PackedNormal, max_clusters> packed;
  packed.fill(no_normal);
  for (std::size_t k = 0; k < max_clusters; ++k) {
    const NormalSum& s = clusters.sum[k];
    const double norm = std::sqrt(double{s[0]} * s[0] + double{s[1]} * s[1] + double{s[2]} * s[2]);
    if (norm > 0) packed[k] = pack_normal(Vec3{s[0] / norm, s[1] / norm, s[2] / norm});
  }
  return packed;
}

int nearest_cluster(const std::array<PackedNormal, max_clusters>& normals, Vec3 direction) {
  if (normals[1] == no_normal && normals[2] == no_normal) return 0;
  int best = 0;
  double best_dot = -1e300;
  for (int k = 0; k < max_clusters; ++k) {
    const PackedNormal packed = normals[static_cast<std::size_t>(k)];
    if (packed == no_normal) continue;
    const double d = dot(unpack_normal(packed), direction);
    if (d > best_dot) {
      best_dot = d;
      best = k;
    }
  }
  return best;
}

}  // namespace voxweld
