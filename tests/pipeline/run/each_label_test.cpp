// labels.mode = "each", end to end: a closed mesh for each label of a volume.
#include <fmt/format.h>

#include "tests/pipeline/run/label_volumes.h"
#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

const Settings each_mode = {"labels.mode=each"};
const Settings small_tiles =
    each_mode + Settings{"work.brick=16", "work.shard=2", "output.tile_vertices=1024"};

TEST(EachLabel, HasTheMeshOfARunOfItAlone) {
  expect_labels_as_alone(ball_labels(SampleType::u16, {40, 36, 33}), {"work.brick=16"}, 0);
  expect_labels_as_alone(ball_labels(SampleType::u64, {33, 20, 20}), {"work.brick=32"}, 0);
  expect_labels_as_alone(ball_labels(SampleType::i32, {20, 17, 16}), {}, 0);
}

TEST(EachLabel, HasTheMeshOfARunOfItAloneInManyTiles) {
  const RawVolume volume = cell_labels({70, 60, 50}, 6, 0.03, 1);
  expect_labels_as_alone(volume, {"work.brick=16", "work.shard=2", "output.tile_vertices=1024"}, 4);
  expect_labels_as_alone(volume,
                         {"work.brick=16", "work.shard=1", "work.chunk=16",
                          "output.tile_vertices=1500", "simplify.tolerance=2"},
                         2);
}

TEST(EachLabel, HasTheMeshOfARunOfItAloneInNoise) {
  expect_labels_as_alone(cell_labels({34, 33, 20}, 4, 1.0, 2),
                         {"work.brick=16", "work.shard=2", "output.tile_vertices=1024"}, 3);
}

// Slabs and blocks whose octrees collapse above the bricks, and above the shards.
TEST(EachLabel, HasTheMeshOfARunOfItAloneAboveTheBricks) {
  RawVolume volume = volume_of({140, 140, 130}, [](Index3 at) {
    return at.z < 40 ? 3 : 16 * at.z + at.x < 1440 ? 200 : at.y < 70 ? 7 : 0;
  });
  expect_labels_as_alone(volume, {"work.brick=16", "work.shard=2", "simplify.tolerance=0.5"}, 0);
  expect_labels_as_alone(volume,
                         {"work.brick=16", "work.shard=1", "work.chunk=16",
                          "simplify.tolerance=0.5", "surface.border=open", "work.copy=true"},
                         0);
}

std::vector<Settings> label_partitions() {
  return {{"work.brick=16", "work.shard=1", "work.chunk=16"},
          {"work.brick=16", "work.shard=4", "run.threads=1"},
          {"work.brick=32", "work.shard=2", "work.copy=true", "work.chunk=8"},
          {"work.brick=64", "work.shard=1", "work.copy=true", "run.threads=1"},
          {"work.brick=128", "run.memory=64GiB"}};
}

TEST(EachLabel, EveryPartitionGivesTheSameBytes) {
  const RawVolume slabs = volume_of({100, 64, 70}, [](Index3 at) {
    return at.z / 16 == 2 ? 9 : 2 * at.z + at.x < 120 ? 1 : 0;
  });
  for (const RawVolume& volume :
       {cell_labels({70, 60, 50}, 8, 0.02, 3), cell_labels({32, 31, 48}, 3, 1.0, 4), slabs}) {
    const Scene scene(volume);
    const Settings common = each_mode + Settings{"output.tile_vertices=1024"};
    const Tree first = scene.expect_one_tree(common, label_partitions());
    EXPECT_TRUE(first.contains("labels.jsonl"));
  }
}

// A leaf of several cells at the border has its vertex, and so the mesh its end, some cells inside.
TEST(EachLabel, EndsInsideWithLargeLeavesAtAnOpenBorder) {
  const Scene scene(cell_labels({90, 80, 76}, 20, 0.01, 6));
  VOXWELD_EXPECT_DONE(
      scene.run(small_tiles + Settings{"surface.border=open", "simplify.tolerance=0.5"}));
  EXPECT_GT(expect_good(scene.output()).boundary_edges, 0u);
}

}  // namespace
}  // namespace voxweld::testing
