// Nothing is lost: killed at any moment, the next run does what is missing and ends in the bytes of
// a run that nobody disturbed.
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zlib.h>

#include <csignal>
#include <cstdlib>
#include <fstream>

#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;

// VOXWELD_KILLS: how many times a run is killed before it may end.
int kills_asked() {
  const char* text = std::getenv("VOXWELD_KILLS");
  return text == nullptr ? 4 : std::max(1, std::atoi(text));
}

struct Killed {
  int by_signal = 0, by_itself = 0;
};

// Kills runs at random moments of the time a whole one takes, then lets one end.
Killed run_through_kills(const Scene& scene, const Settings& settings, unsigned seed) {
  const ProgramResult undisturbed = scene.run_in("timing", settings);
  VOXWELD_EXPECT_DONE(undisturbed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> moment(0, undisturbed.seconds);
  Killed killed;
  for (int i = 0; i < kills_asked(); ++i) {
    const ProgramResult result = scene.run(settings, Stop{SIGKILL, moment(random)});
    if (result.exit_code == 128 + SIGKILL) {
      ++killed.by_signal;
    } else {  // it was done before the moment came: from the start again
      VOXWELD_EXPECT_DONE(result);
      ++killed.by_itself;
      fs::remove_all(scene.output());
      if (i % 2 == 0) fs::remove_all(scene.work());
    }
  }
  VOXWELD_EXPECT_DONE(scene.run(settings));
  return killed;
}

void expect_whole_after_kills(const Scene& scene, const Settings& settings, unsigned seed) {
  const Tree clean = scene.clean_tree(settings);
  const Killed killed = run_through_kills(scene, settings, seed);
  EXPECT_EQ(killed.by_signal + killed.by_itself, kills_asked());
  EXPECT_EQ(difference(clean, output_tree(scene.output())), "") << "seed " << seed;
  EXPECT_TRUE(temporary_files(scene.work()).empty());
  EXPECT_TRUE(temporary_files(scene.output()).empty());
}

TEST(Kill, APartReadInPlace) {
  expect_whole_after_kills(Scene("part", 96), {"work.brick=16", "work.shard=2"}, 1);
}

TEST(Kill, APorousVolumeThroughTheStore) {
  expect_whole_after_kills(
      Scene("porous", 64),
      {"work.brick=16", "work.shard=2", "work.copy=true", "output.tile_vertices=1024"}, 2);
}

TEST(Kill, NoiseInManyTiles) {
  expect_whole_after_kills(Scene(noise_volume({45, 40, 38}, 3)),
                           {"work.brick=16", "work.shard=2", "output.tile_vertices=2000"}, 3);
}

// A stream is spooled first: one more file that may be cut short.
TEST(Kill, ACompressedVolumeThroughSpoolAndStore) {
  const RawVolume volume = noise_volume({40, 36, 30}, 4);
  const Scene scene("sphere", 8);  // its volume makes room for another one
  const fs::path path = scene.volume();
  const std::string header =
      "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 40 36 30\nspacings: 1 1 1\nencoding: gzip\n\n";
  std::ofstream(path) << header;
  gzFile out = gzopen(path.c_str(), "ab");
  ASSERT_NE(out, nullptr);
  gzwrite(out, volume.samples.data(), static_cast<unsigned>(volume.samples.size()));
  gzclose(out);
  const Settings settings = {"surface.isovalue=128", "work.brick=16", "work.shard=2",
                             "simplify.tolerance=2"};
  expect_whole_after_kills(scene, settings, 4);
}

TEST(Kill, EveryStageOfAChangedRun) {
  const Scene scene("part", 64);
  const Settings before = {"work.brick=16", "output.tile_vertices=1024"};
  const Settings after = before + Settings{"simplify.tolerance=0.4", "output.formats=[\"drc\"]"};
  const Tree clean = scene.clean_tree(after);
  std::mt19937 random(5);
  for (int i = 0; i < kills_asked(); ++i) {
    fs::remove_all(scene.work());
    fs::remove_all(scene.output());
    const ProgramResult first = scene.run(before);
    VOXWELD_EXPECT_DONE(first);
    const double moment = std::uniform_real_distribution<double>(0, first.seconds)(random);
    scene.run(after, Stop{SIGKILL, moment});
    VOXWELD_EXPECT_DONE(scene.run(after));
    EXPECT_EQ(difference(clean, output_tree(scene.output())), "") << "killed after " << moment;
  }
}

TEST(Kill, CtrlCEndsWithAMessageAndResumes) {
  const Scene scene(noise_volume({64, 64, 60}, 6));
  const Settings settings = {"work.brick=16", "work.shard=2", "run.threads=1"};
  const Tree clean = scene.clean_tree(settings);
  bool interrupted = false;
  for (double after = 0.3; !interrupted && after > 0.001; after /= 2) {
    fs::remove_all(scene.work());
    fs::remove_all(scene.output());
    const ProgramResult result = scene.run(settings, Stop{SIGINT, after});
    if (result.exit_code == 0) continue;             // it was done by then
    if (result.exit_code == 128 + SIGINT) continue;  // before the program could have a handler
    interrupted = true;
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_NE(result.err.find("interrupted; what is finished is kept"), std::string::npos)
        << result.err;
    EXPECT_TRUE(temporary_files(scene.work()).empty());
  }
  EXPECT_TRUE(interrupted);
  VOXWELD_EXPECT_DONE(scene.run(settings));
  EXPECT_EQ(difference(clean, output_tree(scene.output())), "");
}

// What a killed process left behind goes; what may belong to one that lives stays.
TEST(Kill, TemporaryFilesOfDeadProcessesGo) {
  const Scene scene("sphere", 32);
  VOXWELD_EXPECT_DONE(scene.run());
  char host[256] = {};
  ASSERT_EQ(gethostname(host, sizeof host - 1), 0);
  const pid_t dead = fork();
  if (dead == 0) _exit(0);
  ASSERT_GT(dead, 0);
  ASSERT_EQ(waitpid(dead, nullptr, 0), dead);
  const auto leave = [](const fs::path& file) { std::ofstream(file) << "half"; };
  const auto name = [](const std::string& of, long pid) {
    return "x.octree.tmp-" + of + "-" + std::to_string(pid) + "-0123456789abcdef";
  };
  const fs::path folder = files_ending(scene.work(), ".octree").at(0).parent_path();
  const fs::path tiles = scene.output() / "tiles";
  const std::vector<fs::path> stale = {folder / name(host, dead), tiles / name(host, dead),
                                       scene.output() / name(host, dead)};
  const std::vector<fs::path> others = {
      folder / name(host, getpid()), folder / name("another.host", dead), tiles / "notes.tmp-mine"};
  for (const auto& file : stale) leave(file);
  for (const auto& file : others) leave(file);
  VOXWELD_EXPECT_DONE(scene.run());
  for (const auto& file : stale) EXPECT_FALSE(fs::exists(file)) << file;
  for (const auto& file : others) EXPECT_TRUE(fs::exists(file)) << file;
}

// Killed between taking the manifest away and writing the new one, a run must not forget which
// files the old listing had.
TEST(Kill, LeftoversAreKnownAfterAKillInEncode) {
  const Scene scene(noise_volume({40, 40, 40}, 8));
  const Settings both = {"output.tile_vertices=1024"};
  const Settings drc = both + Settings{"output.formats=[\"drc\"]"};
  const Tree clean = scene.clean_tree(drc);
  VOXWELD_EXPECT_DONE(scene.run(both));
  bool caught = false;
  for (double after = 0.01; !caught && after < 3; after += 0.01) {
    const ProgramResult result = scene.run(drc, Stop{SIGKILL, after});
    caught = result.exit_code != 0 && !fs::exists(scene.output() / "manifest.json");
    if (result.exit_code != 0) continue;
    VOXWELD_EXPECT_DONE(scene.run(both));  // too late: once more
  }
  ASSERT_TRUE(caught) << "never killed within encode";
  VOXWELD_EXPECT_DONE(scene.run(drc));
  EXPECT_EQ(difference(clean, output_tree(scene.output())), "");
}

}  // namespace
}  // namespace voxweld::testing
