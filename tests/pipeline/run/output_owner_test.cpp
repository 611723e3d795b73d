// An output directory is of one config: its runs wait for each other, and those of others, and
// files that no run has written, are left alone unless somebody says so.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>
#include <thread>

#include "tests/pipeline/run/edit_scene.h"
#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

// Another config beside the scene's, of the same volume, that writes where the scene does.
fs::path other_config(const Scene& scene) {
  fs::path path = scene.directory() / "other.toml";
  fs::copy_file(scene.config(), path);
  std::ofstream(path, std::ios::app)
      << fmt::format("\n[work]\ndirectory = \"other.work\"\n[output]\ndirectory = \"{}\"\n",
                     scene.output().filename().string());
  return path;
}

void expect_refused_by(const ProgramResult& result, const std::vector<std::string>& says) {
  for (const std::string& text : says) expect_refused(result, text);
}

TEST(OutputOwner, IsTheConfigThatWroteIt) {
  const Scene scene("sphere", 24);
  const fs::path other = other_config(scene);
  VOXWELD_EXPECT_DONE(scene.run());
  const Tree before = output_tree(scene.output());
  const Settings run = {"run", other, "--set", "simplify.tolerance=0.5"};
  expect_refused_by(run_voxweld(run), {scene.output(), scene.config(), "--force"});
  EXPECT_EQ(difference(before, output_tree(scene.output())), "");
  VOXWELD_EXPECT_DONE(scene.run({"simplify.tolerance=0.4"}));  // its own runs may

  VOXWELD_EXPECT_DONE(run_voxweld(run + Settings{"--force"}));
  EXPECT_EQ(difference(scene.clean_tree({"simplify.tolerance=0.5"}), output_tree(scene.output())),
            "");
  expect_refused_by(scene.run(), {other});  // now it is the other's
}

TEST(OutputOwner, ThatWasMovedOrRemovedOwnsNothing) {
  const Scene scene("sphere", 24);
  const fs::path other = other_config(scene);
  VOXWELD_EXPECT_DONE(scene.run());
  fs::rename(scene.config(), scene.directory() / "renamed.toml");
  VOXWELD_EXPECT_DONE(run_voxweld({"run", other}));
}

TEST(OutputOwner, IsKnownOfARunThatWasKilled) {
  const Scene scene("sphere", 24);
  const fs::path other = other_config(scene);
  {
    const Environment killed =
        watched(scene, {{"VOXWELD_POINTS_NTH", "1"},
                        {"VOXWELD_POINTS_WITH", "after rename /scene.mesh/tiles"},
                        {"VOXWELD_POINTS_DO", "kill -9 $PPID"}});
    EXPECT_NE(scene.run().exit_code, 0);
  }
  EXPECT_FALSE(fs::exists(scene.output() / "manifest.json"));
  expect_refused_by(run_voxweld({"run", other}), {scene.config()});
  VOXWELD_EXPECT_DONE(scene.run());
}

TEST(OutputOwner, KeepsOtherConfigsOutWhileItRuns) {
  const Scene scene("sphere", 24);
  const fs::path other = other_config(scene), said = scene.directory() / "said";
  const Environment meanwhile = watched(
      scene,
      {{"VOXWELD_POINTS_NTH", "1"},
       {"VOXWELD_POINTS_WITH", ".octree"},
       {"VOXWELD_POINTS_DO",
        fmt::format("'{}' run '{}' --force >'{}' 2>&1; echo \"exit $?\" >>'{}'",
                    program_path().string(), other.string(), said.string(), said.string())}});
  VOXWELD_EXPECT_DONE(scene.run());
  EXPECT_THAT(text_of_file(said), AllOf(HasSubstr("is writing it for " + scene.config().string()),
                                        HasSubstr("exit 2")));
  EXPECT_EQ(difference(scene.clean_tree(), output_tree(scene.output())), "");
}

// They read one stack into one store.
TEST(OutputOwner, RunsOfOneConfigWaitForEachOther) {
  const Scene scene("porous", 48);
  const Settings settings = {"work.brick=16", "work.shard=2", "work.copy=true", "run.threads=2"};
  const Tree clean = scene.clean_tree(settings);
  for (int round = 0; round < 3; ++round) {
    fs::remove_all(scene.work());
    fs::remove_all(scene.output());
    std::vector<ProgramResult> results(4);
    {
      std::vector<std::jthread> at_once;
      at_once.reserve(results.size());
      for (ProgramResult& result : results)
        at_once.emplace_back([&] { result = scene.run(settings); });
    }
    for (const ProgramResult& result : results) VOXWELD_EXPECT_DONE(result);
    EXPECT_EQ(difference(clean, output_tree(scene.output())), "");
    EXPECT_TRUE(temporary_files(scene.work()).empty());
    EXPECT_FALSE(fs::exists(scene.output() / "voxweld.lock"));
  }
}

// Their edits differ, so each replaces shards of the other: the one that comes later waits.
TEST(OutputOwner, RunsWithOtherEditsWaitForTheShardsTheyShare) {
  const Scene scene("sphere", 32);
  const auto edited = [&](const std::string& name, Vec3 at) {
    fs::path path = scene.directory() / (name + ".toml");
    fs::copy_file(scene.config(), path);
    std::ofstream(path, std::ios::app) << fmt::format(
        "\n[work]\ndirectory = '{}'\n[output]\nreport = false\ndirectory = '{}.mesh'\n{}",
        scene.work().string(), name, ball("subtract", at, 6));
    return path;
  };
  const fs::path one = edited("one", {22, 16, 16}), other = edited("other", {10, 16, 16});
  VOXWELD_EXPECT_DONE(run_voxweld({"run", one}));
  const Tree of_one = output_tree(scene.directory() / "one.mesh");
  VOXWELD_EXPECT_DONE(run_voxweld({"run", other}));
  const Tree of_other = output_tree(scene.directory() / "other.mesh");
  ASSERT_NE(difference(of_one, of_other), "");
  for (const char* moment : {".octree", "rename /scene.work/merge", ".tile"}) {
    SCOPED_TRACE(moment);
    for (const char* name : {"one.mesh", "other.mesh"}) fs::remove_all(scene.directory() / name);
    VOXWELD_EXPECT_DONE(run_voxweld({"run", other}));
    fs::remove_all(scene.directory() / "other.mesh");
    const fs::path said = scene.directory() / "said";
    {
      const Environment meanwhile =
          watched(scene, {{"VOXWELD_POINTS_NTH", "1"},
                          {"VOXWELD_POINTS_WITH", moment},
                          {"VOXWELD_POINTS_DO",
                           fmt::format("unset LD_PRELOAD; '{}' run '{}' >'{}' 2>&1 & sleep 1",
                                       program_path().string(), other.string(), said.string())}});
      VOXWELD_EXPECT_DONE(run_voxweld({"run", one}));
    }
    EXPECT_EQ(difference(of_one, output_tree(scene.directory() / "one.mesh")), "");
    // A run lets go of its folder after its last file.
    const fs::path output = scene.directory() / "other.mesh";
    const auto is_done = [&] {
      return fs::exists(output / "manifest.json") && !fs::exists(output / "voxweld.lock");
    };
    for (int i = 0; i < 300 && !is_done(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    EXPECT_EQ(difference(of_other, output_tree(scene.directory() / "other.mesh")), "");
    EXPECT_THAT(text_of_file(said), HasSubstr("at work on the same files for " + one.string()));
  }
}

TEST(OutputOwner, FilesThatNoRunWroteAreInTheWay) {
  for (const char* name :
       {"mesh.drc", "mesh.glb", "tiles.jsonl", "manifest.json", "tiles/8-0-0-0.glb"}) {
    SCOPED_TRACE(name);
    const Scene scene("sphere", 24);
    fs::create_directories(scene.output() / "tiles");
    std::ofstream(scene.output() / name) << "somebody's own";
    expect_refused_by(scene.run(), {(scene.output() / name).filename(), "--force"});
    EXPECT_EQ(text_of_file(scene.output() / name), "somebody's own");
    VOXWELD_EXPECT_DONE(run_voxweld({"run", scene.config(), "--force", "--set", "work.brick=16"}));
    EXPECT_EQ(difference(scene.clean_tree(), output_tree(scene.output())), "");
  }
}

TEST(OutputOwner, OtherFilesStay) {
  const Scene scene("sphere", 24);
  fs::create_directories(scene.output() / "tiles");
  std::ofstream(scene.output() / "notes.txt") << "mine";
  std::ofstream(scene.output() / "tiles" / "notes.txt") << "mine";
  VOXWELD_EXPECT_DONE(scene.run());
  EXPECT_EQ(text_of_file(scene.output() / "notes.txt"), "mine");
  EXPECT_EQ(text_of_file(scene.output() / "tiles" / "notes.txt"), "mine");
}

TEST(OutputOwner, IsNoFolderOfTheUsersOwn) {
  const Scene scene("sphere", 24);
  const std::string here = scene.directory().string();
  expect_refused_by(scene.run({"output.directory=" + here}), {"output.directory", "input's own"});
  expect_refused_by(scene.run({"output.directory=" + here + "/."}), {"output.directory"});
  expect_refused_by(scene.run({"output.directory=" + scene.work().string()}),
                    {"output.directory", "work.directory"});
}

}  // namespace
}  // namespace voxweld::testing
