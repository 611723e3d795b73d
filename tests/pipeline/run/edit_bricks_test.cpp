// What of a shard is built again when its edits change.
#include <gmock/gmock.h>

#include <random>

#include "storage/artifact/shard_artifact.h"
#include "storage/support/hash.h"
#include "tests/pipeline/run/edit_scene.h"
#include "tests/pipeline/run/label_volumes.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

// One shard of 4 x 4 x 4 bricks of 16 cells, but for the layers of the ring's cells.
const Settings one_shard = {"work.brick=16", "work.shard=4", "output.tile_vertices=1024"};

std::vector<fs::path> octrees_of(const fs::path& work) {
  return files_ending(work, ".octree");
}

// Of a volume whose bricks all have a surface.
class EditBricks : public ::testing::TestWithParam<const char*> {
 protected:
  bool of_labels() const { return mode() != "off"; }
  std::string param() const { return GetParam(); }
  bool is_safe() const { return param().starts_with("safe"); }
  std::string mode() const {
    return param() == "safe" ? "off" : param() == "safe_each" ? "each" : param();
  }
  Settings settings() const {
    return one_shard + Settings{"labels.mode=" + mode()} +
           (is_safe() ? Settings{"simplify.topology=safe"} : Settings{}) +
           (of_labels() ? Settings{"output.tile_vertices=8192"} : Settings{});
  }

  std::unique_ptr<Scene> make_scene(int side) const {
    if (!of_labels()) return std::make_unique<Scene>("gyroid", side);
    return std::make_unique<Scene>(cell_labels({side, side, side}, 60, 0.01, 3));
  }

  // One of two kinds of edits: `add`, and `subtract`, or between labels `replace`.
  std::string cut(bool first, Vec3 center, double radius, int material) const {
    if (!of_labels()) return ball(first ? "add" : "subtract", center, radius);
    return ball(first ? "add" : "replace", center, radius) +
           fmt::format("material = {}\n", material);
  }

  // Name -> content of each shard's artifact.
  Tree shards_of(const fs::path& work) const {
    Tree tree;
    for (const fs::path& path : octrees_of(work)) {
      const ArtifactReader artifact(path, shard_kind, shard_version);
      tree[path.filename().string()] = to_hex(artifact.key()) + to_hex(artifact.content_hash());
    }
    return tree;
  }

  std::string random_edits(std::mt19937& random) const {
    const auto number = [&](double from, double to) {
      return std::uniform_real_distribution<double>(from, to)(random);
    };
    std::string text;
    for (int i = 0; i < 4; ++i) {
      const Vec3 center{number(-5, 70), number(-5, 70), number(-5, 70)};
      text += cut(random() % 3 == 0, center, number(2, 20), static_cast<int>(random() % 64));
    }
    return text;
  }
};

// Whatever the edits were before: shards are, to the bit, what they are when built at once.
TEST_P(EditBricks, AShardIsTheSameAsOneBuiltAtOnce) {
  const auto scene = make_scene(64);
  const EditScene edits(*scene);
  std::mt19937 random(7);
  bool kept = false;
  std::string text = random_edits(random);
  for (int round = 0; round < 5; ++round) {
    // One of the edits goes and another one comes; now and then all are others.
    text = round % 4 == 3
               ? random_edits(random)
               : text.substr(text.find("[[edit]]", 1)) +
                     cut(round % 2 == 0, {8.0 * round, 40, 30 - 2.0 * round}, 4 + round, 7);
    edits.set(text);
    const ProgramResult run = scene->run(settings());
    VOXWELD_EXPECT_DONE(run);
    kept = kept || run.err.find(" kept: no edit") != std::string::npos;
    scene->forget("fresh");
    VOXWELD_EXPECT_DONE(scene->run_in("fresh", settings()));
    EXPECT_EQ(difference(shards_of(scene->work("fresh")), shards_of(scene->work())), "") << text;
    EXPECT_EQ(difference(output_tree(scene->output("fresh")), output_tree(scene->output())), "");
  }
  EXPECT_TRUE(kept);
}

// A ball inside of one brick touches it alone, one at a corner of bricks the eight around it.
TEST_P(EditBricks, OnlyThoseItReachesAreBuiltAgain) {
  const auto scene = make_scene(60);
  const EditScene edits(*scene);
  VOXWELD_EXPECT_DONE(scene->run(settings()));
  edits.set(cut(false, {24, 24, 24}, 4, 9));
  EXPECT_THAT(scene->run(settings()).err, HasSubstr("bricks 1 were built and 63 kept"));
  edits.set(cut(false, {31, 31, 31}, 3, 9));
  // The one that it left, and those it came to, of which that is one.
  EXPECT_THAT(scene->run(settings()).err, HasSubstr("bricks 8 were built and 56 kept"));
  edits.set("");
  EXPECT_THAT(scene->run(settings()).err, HasSubstr("bricks 8 were built and 56 kept"));
}

INSTANTIATE_TEST_SUITE_P(Modes, EditBricks,
                         ::testing::Values("off", "safe", "each", "safe_each", "shared"),
                         [](const auto& mode) { return std::string(mode.param); });

TEST(EditedShard, NothingIsKeptOfOtherSamples) {
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

TEST_P(EditBricks, NothingIsKeptOfADamagedShard) {
  const auto scene = make_scene(36);
  const EditScene edits(*scene);
  const std::string edit = cut(false, {24, 24, 24}, 4, 9);
  edits.set(edit);
  const Tree expected = scene->clean_tree(settings());
  for (int i = 1; i < 12; ++i) {
    fs::remove_all(scene->work());
    edits.set("");
    VOXWELD_EXPECT_DONE(scene->run(settings()));
    const fs::path path = octrees_of(scene->work()).at(0);
    const auto at =
        static_cast<std::streamoff>(fs::file_size(path) * static_cast<unsigned>(i) / 12);
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekg(at);
    const int byte = file.get();
    file.seekp(at);
    file.put(static_cast<char>(byte ^ 4));
    file.close();
    edits.set(edit);
    VOXWELD_EXPECT_DONE(scene->run(settings()));
    EXPECT_EQ(difference(expected, output_tree(scene->output())), "") << at;
  }
}

}  // namespace
}  // namespace voxweld::testing
