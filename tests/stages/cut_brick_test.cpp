#include "stages/build/cut_brick.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <span>

#include "stages/build/build_brick.h"
#include "tests/stages/cluster_volumes.h"
#include "tests/stages/same_octree.h"

namespace voxweld {
namespace {

using testing::by_sheets;
using testing::expect_same;
using testing::MemoryVolume;

BrickOctree build(const MemoryVolume& volume, const BrickPlace& place, double tolerance) {
  static BrickScratch scratch;
  BrickOctree out;
  const HaloBlock block{volume.type,           volume.size,   {{}, volume.size},
                        volume.samples.data(), volume.size.x, volume.size.x * volume.size.y};
  build_brick(block, place, by_sheets(tolerance), scratch, out);
  return out;
}

constexpr double tolerances[] = {0, 0.02, 0.1, 0.3, 0.6, 1.7, 12, testing::infinite};

// Cuts of each tolerance at all larger ones; how many clusters were there to be cut, in all.
std::size_t check_cuts(const MemoryVolume& volume, const BrickPlace& place) {
  std::vector<BrickOctree> built;
  for (const double tolerance : tolerances) built.push_back(build(volume, place, tolerance));
  std::size_t clusters = 0;
  BrickCutter cutter;
  BrickOctree cut, again;
  for (std::size_t from = 0; from < built.size(); ++from) {
    clusters += built[from].levels.clusters.size();
    if (built[from].roots.empty()) continue;
    for (std::size_t to = from; to < built.size(); ++to) {
      SCOPED_TRACE(::testing::Message() << tolerances[from] << " -> " << tolerances[to]);
      cutter.cut(built[from], tolerances[to], cut);
      expect_same(cut, built[to]);
      cutter.cut(cut, tolerances[to], again);
      expect_same(again, built[to]);
    }
  }
  return clusters;
}

TEST(CutBrick, IsWhatBuildMakesAtAnyLargerTolerance) {
  for (unsigned seed = 0; seed < 2; ++seed)
    for (const MemoryVolume& volume : {testing::plates(61, seed), testing::noise_volume(40, seed)})
      for (const int level : {4, 6}) {
        std::size_t clusters = 0;
        const std::int64_t side = std::int64_t{1} << level;
        each_index(splat((volume.size.x + side) / side), [&](Index3 at) {
          clusters += check_cuts(volume, {at * side, level});
        });
        EXPECT_GT(clusters, 1000u);
      }
}

TEST(CutBrick, KeepsNoMoreThanTheLevelsNeed) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    const BrickOctree octree = build(testing::plates(61, seed), {{}, 6}, 0.02);
    const BrickLevels& levels = octree.levels;
    ASSERT_EQ(levels.errors.size(), octree.vertices.size());
    ASSERT_EQ(levels.parents.size(), octree.vertices.size());
    for (std::size_t i = 0; i < levels.clusters.size(); ++i) {
      const KeptCluster& cluster = levels.clusters[i];
      EXPECT_GT(cluster.error, 0.02F);
      if (cluster.parent == BrickLevels::none) continue;
      ASSERT_LT(cluster.parent, i);
      EXPECT_LT(cluster.error, levels.clusters[cluster.parent].error);
    }
    EXPECT_LT(levels.clusters.size(), octree.vertices.size());
  }
}

}  // namespace
}  // namespace voxweld
