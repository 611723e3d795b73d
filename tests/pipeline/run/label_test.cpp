// surface.label, end to end: one label of a label volume.

#include "pipeline/output/load.h"
#include "tests/pipeline/run/label_volumes.h"
#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

Settings label(std::uint64_t value) {
  return {"surface.label=" + std::to_string(value), "surface.isovalue=" + std::to_string(value)};
}

TEST(Label, IsAClosedMeshOfItsVolume) {
  for (const SampleType type : {SampleType::u16, SampleType::i32, SampleType::u64}) {
    const Scene scene(ball_labels(type, {40, 36, 33}));
    const std::uint64_t more = type == SampleType::u64 ? std::uint64_t{1} << 40 : 0;
    VOXWELD_EXPECT_DONE(scene.run(label(112 + more)));
    expect_good(scene.output());
    const double ball = 4.0 / 3 * 3.14159265 * 9 * 9 * 9;  // cut by its cell's faces
    const double volume = enclosed_volume(load_mesh(scene.output() / "mesh.drc"));
    EXPECT_GT(volume, 0.75 * ball);
    EXPECT_LT(volume, 1.02 * ball);
  }
}

TEST(Label, EveryPartitionGivesTheSameBytes) {
  for (const Index3 size : {Index3{48, 40, 33}, Index3{32, 32, 32}}) {
    const Scene scene(ball_labels(SampleType::u16, size));
    const Settings common = label(12) + Settings{"output.tile_vertices=1024"};
    scene.expect_one_tree(
        common, {Settings{"work.brick=16", "work.shard=1", "work.chunk=16"},
                 Settings{"work.brick=16", "work.shard=2", "work.copy=true", "work.chunk=8"},
                 Settings{"work.brick=32", "work.shard=1", "work.copy=true", "run.threads=1"}});
  }
}

TEST(Label, NoiseIsClosedToo) {
  RawVolume volume = noise_volume({40, 33, 21}, 7);
  for (std::byte& sample : volume.samples) sample &= std::byte{3};
  const Scene scene(volume);
  VOXWELD_EXPECT_DONE(scene.run(label(2) + Settings{"work.brick=16", "output.tile_vertices=4096"}));
  expect_good(scene.output());
}

TEST(Label, WhatCannotBeIsRefused) {
  const Scene scene(ball_labels(SampleType::u16, {20, 20, 20}));
  const auto refused = [&](const Settings& settings, const std::string& words) {
    const ProgramResult result = scene.run(settings);
    expect_refused(result, words);
  };
  refused(label(77), "surface.label = 77: no sample");
  refused({"surface.label=1", "surface.isovalue=2.5"}, "surface.isovalue = 2.5: a label has no");
  refused(label(1) + Settings{"surface.inside=below"}, "surface.inside");
  refused({"surface.label=-1"}, "surface.label");
  RawVolume real{{8, 8, 8}, SampleType::f32, std::vector<std::byte>(8 * 8 * 8 * 4), 0};
  const Scene floats(real);
  const ProgramResult result = floats.run(label(0));
  expect_refused(result, "labels are integers");
}

}  // namespace
}  // namespace voxweld::testing
