// Partition invariance, end to end: whatever chunk, brick and shard size, threads and copy, the
// same bytes come out.
#include <fmt/format.h>

#include "storage/artifact/shard_artifact.h"
#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

// Twelve of the 144 partitions, in which each two of their values meet: each brick with each shard
// and each chunk, each of these with and without a copy and on one thread and two.
std::vector<Settings> partitions() {
  std::vector<Settings> all;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 3; ++column)
      all.push_back({fmt::format("work.brick={}", 16 << row),
                     fmt::format("work.shard={}", 1 << column),
                     fmt::format("work.chunk={}", 8 << ((row + column) % 3)),
                     fmt::format("work.copy={}", (row + column) % 2 == 0),
                     fmt::format("run.threads={}", 1 + (row / 2 + column) % 2),
                     "run.memory=64GiB"});  // of bricks of 128 the worst there is
  return all;
}

std::vector<Settings> one_of_each_brick() {
  const std::vector<Settings> all = partitions();
  return {all[0], all[4], all[8], all[9]};
}

// One with bricks of 16 and one with others, for volumes where the shape is what is interesting:
// they take turns.
std::vector<Settings> some_partitions(std::size_t turn) {
  const std::vector<Settings> all = partitions();
  return {all[turn % 3], all[3 + turn % 9]};
}

TEST(Partition, OfAPartWithFlatFaces) {
  const Scene scene("part", 96);
  scene.expect_one_tree({}, one_of_each_brick());
  VOXWELD_EXPECT_DONE(scene.run({"work.brick=16"}));
  const auto leaves = manifest_of(scene.output()).at("counts").at("leaves");
  EXPECT_GT(leaves.size(), 5u) << "no leaf is larger than a brick of 16 cells: " << leaves;
}

TEST(Partition, OfNoise) {
  const Scene scene(noise_volume({33, 21, 27}, 1));
  scene.expect_one_tree({}, partitions());
}

TEST(Partition, OfAPorousVolumeInManyTiles) {
  const Scene scene("porous", 64);
  const Tree tree = scene.expect_one_tree({"output.tile_vertices=1024"}, some_partitions(0));
  EXPECT_GT(tree.size(), 20u);
}

// A volume that is one shard, whoever of several threads has built its bricks.
TEST(Partition, OfOneShardOnManyThreads) {
  const Scene smooth("porous", 100), noise(noise_volume({60, 50, 70}, 5)),
      labels(integer_volume(SampleType::u8, {90, 70, 80}, [](Index3 at) {
        return (at.x / 9 + at.y / 7 * 3 + at.z / 11 * 5) % 6;
      }));
  const auto content = [&](const Scene& scene, const Settings& settings) {
    const Settings all = settings + Settings{"work.brick=16", "work.shard=8"};
    scene.forget();
    VOXWELD_EXPECT_DONE(scene.command("ingest", all));
    VOXWELD_EXPECT_DONE(scene.command("build", all));
    const auto files = files_ending(scene.work(), ".octree");
    EXPECT_EQ(files.size(), 1U);
    return ShardArtifact(files.at(0)).content_hash();
  };
  const auto expect_one = [&](const Scene& scene, const Settings& mode) {
    const Hash128 one = content(scene, mode + Settings{"run.threads=1"});
    for (const char* memory : {"run.memory=64GiB", "run.memory=160MiB"})
      for (const char* threads : {"run.threads=2", "run.threads=7"})
        EXPECT_EQ(one, content(scene, mode + Settings{memory, threads}))
            << memory << ' ' << threads;
  };
  expect_one(smooth, {});
  expect_one(noise, {});
  expect_one(noise, {"simplify.topology=safe"});
  expect_one(labels, {"labels.mode=each"});
  expect_one(labels, {"labels.mode=shared"});
}

// A turned plane over several bricks, inside them: leaves above brick 16 and above 32 exist, and
// what a brick of 64 collapses within itself, bricks of 16 leave to the nodes above.
TEST(Partition, OfNodesCollapsedAboveTheBricks) {
  const Scene scene(
      volume_of({140, 140, 130}, [](Index3 at) { return 16 * at.z + at.x < 1280 ? 200 : 20; }));
  const Scene flat(volume_of({150, 140, 130}, [](Index3 at) { return at.z < 80 ? 200 : 20; }));
  for (const Scene* each : {&scene, &flat}) {
    const Settings tolerance = {"simplify.tolerance=0.5"};
    each->expect_one_tree(tolerance, one_of_each_brick());
    VOXWELD_EXPECT_DONE(each->run(tolerance + Settings{"work.brick=16", "work.shard=2"}));
    const auto leaves = manifest_of(each->output()).at("counts").at("leaves");
    EXPECT_GT(leaves.size(), 5u) << "no leaf is larger than a brick of 16 cells: " << leaves;
  }
}

// Whether this processor has what the kernels of that name need.
bool processor_has(const std::string& kernels) {
#if defined(__x86_64__)
  if (kernels == "avx2") return __builtin_cpu_supports("avx2");
  if (kernels == "avx512")
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vl");
#endif
  return kernels == "base";
}

// The processors of a cluster's nodes may differ.
TEST(Partition, OfProcessorsWithOtherVectorUnits) {
  const Scene scene("porous", 64);
  const Tree tree = scene.clean_tree();
  for (const std::string kernels : {"base", "avx2", "avx512", "mmx"}) {
    SCOPED_TRACE(kernels);
    const Environment chosen({{"VOXWELD_KERNELS", kernels}});
    if (processor_has(kernels)) {
      EXPECT_EQ(difference(tree, scene.clean_tree()), "");
      continue;
    }
    const ProgramResult refused = scene.run();
    expect_refused(refused, "VOXWELD_KERNELS = \"" + kernels + "\"");
  }
}

TEST(Partition, OfAnisotropicSpacing) {
  RawVolume volume = volume_of({50, 41, 37}, [](Index3 at) {
    const auto d = at - Index3{24, 20, 17};
    return 250 - (d.x * d.x + 2 * d.y * d.y + 3 * d.z * d.z) / 4;
  });
  volume.spacing = {0.337891, 0.25, 1.7};
  Scene(volume).expect_one_tree({}, some_partitions(1));
}

// The ring's cells begin a layer of bricks of their own.
TEST(Partition, OfSizesThatAreMultiplesOfTheBrick) {
  std::size_t turn = 0;  // bricks of 16 and of 32
  for (const Index3 size : {Index3{32, 32, 32}, Index3{64, 16, 31}, Index3{15, 63, 32}})
    Scene(noise_volume(size, 3)).expect_one_tree({}, some_partitions(turn++));
}

// At the border the stencils of either gradient are one-sided, also where a brick begins there.
TEST(Partition, OfEitherGradient) {
  const Scene scene(noise_volume({32, 64, 32}, 4));
  for (const char* gradient : {"eno", "central", "subcell", "auto"})
    scene.expect_one_tree({std::string("surface.gradient=") + gradient}, some_partitions(2));
}

TEST(Partition, OfThinVolumes) {
  const std::vector<Settings> all = partitions();
  std::size_t turn = 0;
  for (const Index3 size :
       {Index3{40, 35, 1}, Index3{1, 40, 35}, Index3{35, 1, 40}, Index3{34, 33, 2},
        Index3{1, 1, 70}, Index3{70, 1, 1}, Index3{1, 1, 1}}) {
    RawVolume volume = noise_volume(size, 5);
    volume.samples.back() = std::byte{255};                // a surface for certain
    Scene(volume).expect_one_tree({}, {all[turn++ % 6]});  // bricks of 16 and of 32
  }
}

TEST(Partition, OfTypesAndByteOrders) {
  RawVolume volume = noise_volume({26, 19, 17}, 7);
  volume.type = SampleType::i16;
  volume.samples.resize(2 * volume.samples.size(), std::byte{0x7f});
  volume.isovalue = 4000;
  Scene(volume).expect_one_tree({"input.endian=big"}, some_partitions(3));
}

// The whole mesh does not depend on how it was cut for delivery.
TEST(Partition, MergedMeshOfAnyTileSize) {
  const Scene scene("porous", 72);
  const Settings merged = {"output.merged=true"};
  const Tree whole = scene.clean_tree(merged);
  for (const char* vertices : {"1024", "2500", "9000"}) {
    const Tree cut =
        scene.clean_tree(merged + Settings{std::string("output.tile_vertices=") + vertices});
    EXPECT_GT(cut.size(), whole.size()) << vertices;
    for (const char* name : {"mesh.drc", "mesh.glb"})
      EXPECT_EQ(cut.at(name), whole.at(name)) << name << " with " << vertices;
  }
}

}  // namespace
}  // namespace voxweld::testing
