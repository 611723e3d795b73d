// What of a shard is built again when its edits change.
#include <gmock/gmock.h>

#include <random>

#include "storage/artifact/shard_artifact.h"
#include "storage/support/hash.h"
#include "tests/pipeline/run/edit_scene.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

// One shard of 4 x 4 x 4 bricks of 16 cells, but for the layers of the ring's cells.
const Settings one_shard = {"work.brick=16", "work.shard=4", "output.tile_vertices=1024"};

std::vector<fs::path> octrees_of(const fs::path& work) {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::recursive_directory_iterator(work))
    if (entry.path().extension() == ".octree") paths.push_back(entry.path());
  return paths;
}

// Name -> content of each shard's artifact.
Tree shards_of(const fs::path& work) {
  Tree tree;
  for (const fs::path& path : octrees_of(work)) {
    const ShardArtifact artifact(path);
    tree[path.filename().string()] = to_hex(artifact.key()) + to_hex(artifact.content_hash());
  }
  return tree;
}

std::string random_edits(std::mt19937& random) {
  const auto number = [&](double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random);
  };
  std::string text;
  for (int i = 0; i < 4; ++i) {
    const Vec3 center{number(-5, 70), number(-5, 70), number(-5, 70)};
    text += ball(random() % 3 == 0 ? "add" : "subtract", center, number(2, 20));
  }
  return text;
}

// Whatever the edits were before: shards are, to the bit, what they are when built at once.
TEST(EditBricks, AShardIsTheSameAsOneBuiltAtOnce) {
  const Scene scene("gyroid", 64);
  const EditScene edits(scene);
  std::mt19937 random(7);
  bool kept = false;
  std::string text = random_edits(random);
  for (int round = 0; round < 5; ++round) {
    // One of the edits goes and another one comes; now and then all are others.
    text = round % 4 == 3 ? random_edits(random)
                          : text.substr(text.find("[[edit]]", 1)) +
                                ball(round % 2 == 0 ? "add" : "subtract",
                                     {8.0 * round, 40, 30 - 2.0 * round}, 4 + round);
    edits.set(text);
    const ProgramResult run = scene.run(one_shard);
    VOXWELD_EXPECT_DONE(run);
    kept = kept || run.err.find(" kept: no edit") != std::string::npos;
    fs::remove_all(scene.work("fresh"));
    fs::remove_all(scene.output("fresh"));
    VOXWELD_EXPECT_DONE(scene.run_in("fresh", one_shard));
    EXPECT_EQ(difference(shards_of(scene.work("fresh")), shards_of(scene.work())), "") << text;
    EXPECT_EQ(difference(output_tree(scene.output("fresh")), output_tree(scene.output())), "");
  }
  EXPECT_TRUE(kept);
}

// A ball inside of one brick touches it alone, one at a corner of bricks the eight around it.
TEST(EditBricks, OnlyThoseItReachesAreBuiltAgain) {
  const Scene scene("gyroid", 60);
  const EditScene edits(scene);
  VOXWELD_EXPECT_DONE(scene.run(one_shard));
  edits.set(ball("subtract", {24, 24, 24}, 4));
  EXPECT_THAT(scene.run(one_shard).err, HasSubstr("bricks 1 were built and 63 kept"));
  edits.set(ball("subtract", {31, 31, 31}, 3));
  // The one that it left, and those it came to, of which that is one.
  EXPECT_THAT(scene.run(one_shard).err, HasSubstr("bricks 8 were built and 56 kept"));
  edits.set("");
  EXPECT_THAT(scene.run(one_shard).err, HasSubstr("bricks 8 were built and 56 kept"));
}

TEST(EditBricks, NothingIsKeptOfOtherSamples) {
  const Scene scene(noise_volume({30, 30, 30}, 4));
  const EditScene edits(scene);
  VOXWELD_EXPECT_DONE(scene.run(one_shard));
  scene.write_volume(noise_volume({30, 30, 30}, 5));
  edits.set(ball("subtract", {24, 24, 24}, 4));
  const ProgramResult run = scene.run(one_shard);
  VOXWELD_EXPECT_DONE(run);
  EXPECT_THAT(run.err, Not(HasSubstr("kept: no edit")));
  EXPECT_EQ(difference(scene.clean_tree(one_shard), output_tree(scene.output())), "");
}

TEST(EditBricks, NothingIsKeptOfADamagedShard) {
  const Scene scene("part", 60);
  const EditScene edits(scene);
  edits.set(ball("subtract", {24, 24, 24}, 4));
  const Tree expected = scene.clean_tree(one_shard);
  for (int i = 1; i < 12; ++i) {
    fs::remove_all(scene.work());
    edits.set("");
    VOXWELD_EXPECT_DONE(scene.run(one_shard));
    const fs::path path = octrees_of(scene.work()).at(0);
    const auto at =
        static_cast<std::streamoff>(fs::file_size(path) * static_cast<unsigned>(i) / 12);
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekg(at);
    const int byte = file.get();
    file.seekp(at);
    file.put(static_cast<char>(byte ^ 4));
    file.close();
    edits.set(ball("subtract", {24, 24, 24}, 4));
    VOXWELD_EXPECT_DONE(scene.run(one_shard));
    EXPECT_EQ(difference(expected, output_tree(scene.output())), "") << at;
  }
}

}  // namespace
}  // namespace voxweld::testing
