#include "stages/contouring/normal_clusters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace voxweld {
namespace {

constexpr std::array<PackedNormal, max_clusters> none{no_normal, no_normal, no_normal};

std::size_t count(const NormalClusters& clusters) {
  return static_cast<std::size_t>(
      std::count_if(clusters.sum.begin(), clusters.sum.end(),
                    [](const NormalSum& s) { return s != NormalSum{}; }));
}

TEST(NormalClusters, OutwardTellsASurfacesTwoSidesApart) {
  const std::vector<NormalSum> sums{{0, 0, 1}, {0, 0, -1}, {0, 0, 2}};
  const NormalClusters clusters = cluster_normals(sums, NormalSense::outward);
  EXPECT_EQ(count(clusters), 2u);
  EXPECT_EQ(clusters.sum[0], (NormalSum{0, 0, 3}));
  EXPECT_EQ(clusters.sum[1], (NormalSum{0, 0, -1}));
}

TEST(NormalClusters, OfEitherSenseTheyAreOneDirection) {
  const std::vector<NormalSum> sums{{0, 0, -1}, {0, 0.1f, 1}, {0, 0, 2}};
  const NormalClusters clusters = cluster_normals(sums, NormalSense::either);
  EXPECT_EQ(count(clusters), 1u);
  EXPECT_EQ(clusters.sum[0], (NormalSum{0, -0.1f, -4}));
}

// The foot of a box that stands on a plate behind which the plate's surface goes on: the plate's
// normal both ways and two walls.
TEST(NormalClusters, OfEitherSenseThreePlanesHaveRoom) {
  const std::vector<NormalSum> sums{{0, 0, 1}, {1, 0, 0}, {0, 0, -3}, {0, -1, 0}, {-1, 0, 0}};
  const NormalClusters clusters = cluster_normals(sums, NormalSense::either);
  EXPECT_EQ(clusters.sum, (std::array<NormalSum, max_clusters>{
                              NormalSum{0, 0, 4}, NormalSum{2, 0, 0}, NormalSum{0, -1, 0}}));
  // With senses there is none: what the two sides of the plate sum up to is no direction of it.
  const NormalClusters outward = cluster_normals(sums, NormalSense::outward);
  EXPECT_NE(outward.sum[0], (NormalSum{0, 0, 1}));
}

// One child of either sense, and the sense of what is added says nothing any more.
TEST(NormalClusters, MergesOfEitherSenseAreThoseOfTurnedChildren) {
  const std::vector<NormalSum> sums{{0.1f, 0, 1}, {0.8f, 0.1f, 0.1f}, {0, 0.1f, 2}, {0.1f, 1, 0}};
  const NormalClusters expected = cluster_normals(sums, NormalSense::either);
  for (unsigned turned = 0; turned < 16; ++turned) {
    ClusterMerge merge;
    for (std::size_t i = 0; i < sums.size(); ++i) {
      NormalClusters child{{}, i == 2 ? NormalSense::either : NormalSense::outward};
      const float sign = (turned >> i & 1) != 0 ? -1.0f : 1.0f;
      for (std::size_t a = 0; a < 3; ++a) child.sum[0][a] = sign * sums[i][a];
      merge.add(child);
    }
    const NormalClusters merged = merge.merged();
    EXPECT_EQ(merged.sense, NormalSense::either);
    for (std::size_t k = 0; k < max_clusters; ++k) {
      NormalSum opposite = expected.sum[k];
      for (float& x : opposite) x = -x;
      EXPECT_TRUE(merged.sum[k] == expected.sum[k] || merged.sum[k] == opposite) << turned;
    }
  }
}

TEST(NormalClusters, ACornerTakesTheNearestDirection) {
  auto normals = none;
  normals[0] = pack_normal({0, 0, 1});
  normals[1] = pack_normal({1, 0, 0});
  EXPECT_EQ(nearest_cluster(normals, {2, 0, 1}, NormalSense::outward),
            CornerNormal::make(1, false));
  EXPECT_EQ(nearest_cluster(normals, {-2, 0, 1}, NormalSense::outward),
            CornerNormal::make(0, false));
  const CornerNormal turned = nearest_cluster(normals, {-2, 0, 1}, NormalSense::either);
  EXPECT_EQ(turned, CornerNormal::make(1, true));
  EXPECT_LT(turned.of(normals).x, -0.999);
  normals[1] = no_normal;
  EXPECT_EQ(nearest_cluster(normals, {0, 0, -1}, NormalSense::outward),
            CornerNormal::make(0, false));
  EXPECT_EQ(nearest_cluster(normals, {0, 0, -1}, NormalSense::either), CornerNormal::make(0, true));
}

TEST(NormalClusters, CornersKnowWhatTheyMayBe) {
  for (unsigned bits = 0; bits < 256; ++bits)
    EXPECT_EQ(CornerNormal{static_cast<std::uint8_t>(bits)}.valid(),
              bits < CornerNormal::values && bits % 4 != 3);
}

}  // namespace
}  // namespace voxweld
