// Partition invariance, end to end: whatever chunk, brick and shard size, threads and copy, the
// same bytes come out.
#include <fmt/format.h>

#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

// Every brick with every shard, with and without a copy; chunk and threads take turns.
std::vector<Settings> partitions() {
  std::vector<Settings> all;
  for (int brick = 16, row = 0; brick <= 128; brick *= 2, ++row)
    for (int shard = 1, column = 0; shard <= 4; shard *= 2, ++column)
      for (const bool copy : {false, true}) {
        const int chunk = 8 << ((row + column) % 3), threads = 1 + (row + column + copy) % 2;
        all.push_back({fmt::format("work.brick={}", brick), fmt::format("work.shard={}", shard),
                       fmt::format("work.chunk={}", std::min(chunk, brick * shard)),
                       fmt::format("work.copy={}", copy), fmt::format("run.threads={}", threads)});
      }
  return all;
}

std::string described(const Settings& settings) {
  std::string text;
  for (const std::string& setting : settings) text += setting + " ";
  return text;
}

Tree expect_same_for_all(const Scene& scene, const std::vector<Settings>& variants,
                         const Settings& common = {}) {
  const Tree first = scene.clean_tree(common);
  for (const Settings& variant : variants)
    EXPECT_EQ(difference(first, scene.clean_tree(common + variant)), "") << described(variant);
  return first;
}

// Only some of the partitions, for volumes where the shape is what is interesting.
std::vector<Settings> some_partitions() {
  const std::vector<Settings> all = partitions();
  std::vector<Settings> some;
  for (std::size_t i = 0; i < all.size(); i += 5) some.push_back(all[i]);
  return some;
}

TEST(Partition, OfAPartWithFlatFaces) {
  const Scene scene("part", 96);
  expect_same_for_all(scene, partitions());
  VOXWELD_EXPECT_DONE(scene.run({"work.brick=16"}));
  const auto leaves = manifest_of(scene.output()).at("counts").at("leaves");
  EXPECT_GT(leaves.size(), 5u) << "no leaf is larger than a brick of 16 cells: " << leaves;
}

TEST(Partition, OfNoise) {
  const Scene scene(noise_volume({33, 21, 27}, 1));
  expect_same_for_all(scene, partitions());
}

TEST(Partition, OfAPorousVolumeInManyTiles) {
  const Scene scene("porous", 64);
  const Tree tree = expect_same_for_all(scene, some_partitions(), {"output.tile_vertices=1024"});
  EXPECT_GT(tree.size(), 20u);
}

// A turned plane over several bricks, inside them: leaves above brick 16 and above 32 exist, and
// what a brick of 64 collapses within itself, bricks of 16 leave to the nodes above.
TEST(Partition, OfNodesCollapsedAboveTheBricks) {
  const Scene scene(
      volume_of({140, 140, 130}, [](Index3 at) { return 16 * at.z + at.x < 16 * 80 ? 200 : 20; }));
  const Scene flat(volume_of({150, 140, 130}, [](Index3 at) { return at.z < 80 ? 200 : 20; }));
  for (const Scene* each : {&scene, &flat}) {
    const Settings tolerance = {"simplify.tolerance=0.5"};
    expect_same_for_all(*each, some_partitions(), tolerance);
    VOXWELD_EXPECT_DONE(each->run(tolerance + Settings{"work.brick=16", "work.shard=2"}));
    const auto leaves = manifest_of(each->output()).at("counts").at("leaves");
    EXPECT_GT(leaves.size(), 5u) << "no leaf is larger than a brick of 16 cells: " << leaves;
  }
}

// The processors of a cluster's nodes may differ.
TEST(Partition, OfProcessorsWithOtherVectorUnits) {
  const Scene scene("porous", 64);
  std::vector<Tree> trees;
  for (const char* kernels : {"base", "avx2", "avx512"}) {
    setenv("VOXWELD_KERNELS", kernels, 1);
    if (scene.run().exit_code == 0) trees.push_back(scene.clean_tree());
    unsetenv("VOXWELD_KERNELS");
  }
  ASSERT_FALSE(trees.empty());
  for (const Tree& tree : trees) EXPECT_EQ(difference(trees[0], tree), "");
  setenv("VOXWELD_KERNELS", "mmx", 1);
  const auto refused = scene.run();
  unsetenv("VOXWELD_KERNELS");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("VOXWELD_KERNELS = \"mmx\""), std::string::npos) << refused.err;
}

TEST(Partition, OfAnisotropicSpacing) {
  RawVolume volume = volume_of({50, 41, 37}, [](Index3 at) {
    const auto d = at - Index3{24, 20, 17};
    return 250 - (d.x * d.x + 2 * d.y * d.y + 3 * d.z * d.z) / 4;
  });
  volume.spacing = {0.337891, 0.25, 1.7};
  expect_same_for_all(Scene(volume), some_partitions());
}

// The ring's cells begin a layer of bricks of their own.
TEST(Partition, OfSizesThatAreMultiplesOfTheBrick) {
  for (const Index3 size : {Index3{32, 32, 32}, Index3{64, 16, 31}, Index3{15, 63, 32}})
    expect_same_for_all(Scene(noise_volume(size, 3)), some_partitions());
}

// At the border the stencils of either gradient are one-sided, also where a brick begins there.
TEST(Partition, OfEitherGradient) {
  const Scene scene(noise_volume({32, 64, 32}, 4));
  for (const char* gradient : {"eno", "central"})
    expect_same_for_all(scene, some_partitions(), {std::string("surface.gradient=") + gradient});
}

TEST(Partition, OfThinVolumes) {
  for (const Index3 size :
       {Index3{40, 35, 1}, Index3{1, 40, 35}, Index3{35, 1, 40}, Index3{34, 33, 2},
        Index3{1, 1, 70}, Index3{70, 1, 1}, Index3{1, 1, 1}}) {
    RawVolume volume = noise_volume(size, 5);
    volume.samples.back() = std::byte{255};  // a surface for certain
    expect_same_for_all(Scene(volume), some_partitions());
  }
}

TEST(Partition, OfTypesAndByteOrders) {
  RawVolume volume = noise_volume({26, 19, 17}, 7);
  volume.type = SampleType::i16;
  volume.samples.resize(2 * volume.samples.size(), std::byte{0x7f});
  volume.isovalue = 4000;
  expect_same_for_all(Scene(volume), some_partitions(), {"input.endian=big"});
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
