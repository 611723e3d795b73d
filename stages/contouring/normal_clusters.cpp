#include "stages/contouring/normal_clusters.h"

#include <cmath>

namespace voxweld {
namespace {

float dot3(const NormalSum& a, const NormalSum& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
float length(const NormalSum& a) {
  return std::sqrt(dot3(a, a));
}

// Sums are compared and added by their sense, or without it.
class Grouping {
 public:
  Grouping(NormalSense sense, float cosine)
      : either_(sense == NormalSense::either), cosine_(cosine) {}
  float compare(const NormalSum& a, const NormalSum& b) const {
    const float d = dot3(a, b);
    return either_ ? std::abs(d) : d;
  }
  void join(NormalSum& to, const NormalSum& what) const {
    const float sign = either_ && dot3(to, what) < 0 ? -1.0f : 1.0f;
    for (std::size_t i = 0; i < 3; ++i) to[i] += sign * what[i];
  }
  // Within the clusters' angle of `to`; without a division for each pair.
  bool near(const NormalSum& a, const NormalSum& to, float length_of_to) const {
    return compare(a, to) >= cosine_ * length(a) * length_of_to;
  }

 private:
  bool either_;
  float cosine_;
};

}  // namespace

std::optional<NormalSum> one_direction(std::span<const NormalSum> sums, NormalSense sense,
                                       float cosine) {
  const Grouping grouping(sense, cosine);
  NormalSum total{};
  for (const NormalSum& sum : sums) grouping.join(total, sum);
  const float whole = length(total);
  bool one = whole > 0;  // opposite sheets may cancel
  for (const NormalSum& sum : sums) one = one && grouping.near(sum, total, whole);
  return one ? std::optional(total) : std::nullopt;
}

NormalClusters cluster_normals(std::span<const NormalSum> sums, NormalSense sense, float cosine) {
  const Grouping grouping(sense, cosine);
  NormalClusters clusters{{}, sense};
  if (const auto total = one_direction(sums, sense, cosine)) {
    clusters.sum[0] = *total;
    return clusters;
  }
  std::size_t count = 0;
  for (const NormalSum& sum : sums) {
    std::size_t best = 0;
    float best_likeness = -2;
    for (std::size_t k = 0; k < count; ++k) {
      const float scale = length(clusters.sum[k]);
      const float likeness = scale > 0 ? grouping.compare(clusters.sum[k], sum) / scale : -1.0f;
      if (likeness > best_likeness) {
        best_likeness = likeness;
        best = k;
      }
    }
    if (count < max_clusters && best_likeness < cosine * length(sum)) best = count++;
    grouping.join(clusters.sum[best], sum);
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

CornerNormal nearest_cluster(const std::array<PackedNormal, max_clusters>& normals, Vec3 direction,
                             NormalSense sense) {
  const bool either = sense == NormalSense::either;
  if (!either && normals[1] == no_normal && normals[2] == no_normal) return {};
  CornerNormal best;
  double best_dot = -1e300;
  for (int k = 0; k < max_clusters; ++k) {
    const PackedNormal packed = normals[static_cast<std::size_t>(k)];
    if (packed == no_normal) continue;
    const double d = dot(unpack_normal(packed), direction), likeness = either ? std::abs(d) : d;
    if (likeness > best_dot) {
      best_dot = likeness;
      best = CornerNormal::make(k, either && d < 0);
    }
  }
  return best;
}

}  // namespace voxweld
