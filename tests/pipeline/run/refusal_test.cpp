// What a run refuses --dry-run refuses too; what changes nothing is said; a stop at the end stops.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <csignal>
#include <fstream>

#include "storage/support/directory_lock.h"
#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;

// --dry-run and the run itself, with one message.
void expect_both_refuse(const Scene& scene, const Settings& settings, const std::string& words) {
  const ProgramResult dry = scene.command_with("run", settings, {"--dry-run"});
  expect_refused(dry, words);
  EXPECT_EQ(dry.out, "");
  EXPECT_THAT(scene.run(settings).err, EndsWith(dry.err));
}

TEST(DryRun, RefusesFoldersThatCannotBeWritten) {
  const Scene scene("sphere", 24);
  const std::string file = scene.volume().string();
  expect_both_refuse(scene, {"work.directory=" + file + "/w"}, "work.directory = ");
  expect_both_refuse(scene, {"output.directory=" + file + "/o"}, "is not a directory");
}

TEST(DryRun, RefusesMemoryThatIsTooSmall) {
  const Scene scene(noise_volume({96, 96, 96}, 1));
  const Settings little = {"run.memory=64MiB", "work.brick=128", "work.shard=1"};
  const ProgramResult run = scene.run(little);
  ASSERT_EQ(run.exit_code, 2) << run.err;
  expect_both_refuse(scene, little, "run.memory");
}

TEST(DryRun, RefusesTheOutputDirectoryOfAnotherConfig) {
  const Scene scene("sphere", 24);
  VOXWELD_EXPECT_DONE(scene.run());
  const fs::path other = scene.directory() / "other.toml";
  fs::copy_file(scene.config(), other);
  const Settings into = {"--set", "output.directory=" + scene.output().string()};
  const Settings run = Settings{"run", other.string(), "--dry-run"} + into;
  expect_refused(run_voxweld(run), "holds the meshes of " + scene.config().string());
  VOXWELD_EXPECT_DONE(run_voxweld(run + Settings{"--force"}));
  const DirectoryLock lock(scene.output("new"), "/elsewhere/other.toml", {});
  const ProgramResult busy = scene.command_with(
      "run", {"output.directory=" + scene.output("new").string()}, {"--dry-run"});
  expect_refused(busy, "is writing it for /elsewhere/other.toml");
}

TEST(DryRun, RefusesFilesThatNoRunHasWritten) {
  const Scene scene("sphere", 24);
  VOXWELD_EXPECT_DONE(scene.run());
  const fs::path there = scene.output("new");
  fs::create_directories(there);
  std::ofstream(there / "mesh.drc") << "mine";
  expect_both_refuse(scene, {"output.directory=" + there.string()}, "mesh.drc: is in the way");
}

TEST(IdleEdits, AreNamedByTheirNumbers) {
  const Scene scene("sphere", 24);
  std::ofstream(scene.config(), std::ios::app)
      << "[[edit]]\nop = \"subtract\"\nshape = \"sphere\"\ncenter = [12, 12, 20]\nradius = 3\n"
         "[[edit]]\nop = \"add\"\nshape = \"sphere\"\ncenter = [12, 12, 200]\nradius = 3\n"
         "[[edit]]\nop = \"intersect\"\nshape = \"box\"\ncenter = [12, 12, 12]\nsize = [99, 99, "
         "99]\n";
  for (const Arguments& options : {Arguments{}, Arguments{"--dry-run"}}) {
    const ProgramResult run = scene.command_with("run", {}, options);
    VOXWELD_EXPECT_DONE(run);
    EXPECT_THAT(run.err, HasSubstr("warning: edit 2 changes nothing: it lies outside the volume, "
                                   "whose samples run from [0, 0, 0] to [23, 23, 23]; "));
    EXPECT_THAT(run.err, HasSubstr("warning: edit 3 changes nothing: it holds all of the volume"));
    EXPECT_THAT(run.err, Not(HasSubstr("edit 1")));
  }
}

// The merged mesh is done, or all units: what is left are lists and the manifest.
TEST(StopAtTheEnd, LeavesNoManifestAndIsSaid) {
  for (const char* point :
       {"after rename /scene.mesh/mesh.drc", "after rename /scene.mesh/tiles.jsonl"}) {
    const Scene scene("sphere", 24);
    const Settings settings = {"run.threads=1"};
    {
      const Environment stopped = watched(
          scene, {{"VOXWELD_POINTS_AT", point}, {"VOXWELD_POINTS_SIGNAL", std::to_string(SIGINT)}});
      const ProgramResult result = scene.run(settings);
      EXPECT_EQ(result.exit_code, 1) << point << result.err;
      EXPECT_THAT(result.err, HasSubstr("interrupted; what is finished is kept")) << point;
      EXPECT_FALSE(fs::exists(scene.output() / "manifest.json")) << point;
    }
    VOXWELD_EXPECT_DONE(scene.run(settings));
    EXPECT_EQ(difference(scene.clean_tree(settings), output_tree(scene.output())), "") << point;
  }
}

TEST(Summary, CountsOneAsOne) {
  const Scene scene("sphere", 24);
  const ProgramResult run = scene.run();
  VOXWELD_EXPECT_DONE(run);
  EXPECT_THAT(run.out, HasSubstr(", 1 tile, "));
  EXPECT_THAT(run.err, HasSubstr("encode: 1 tile and the merged mesh\n"));
  EXPECT_THAT(run_voxweld({"verify", scene.output().string()}).out, HasSubstr(", 1 tile, "));
}

}  // namespace
}  // namespace voxweld::testing
