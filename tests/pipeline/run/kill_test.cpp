// Nothing is lost: killed at any moment, the next run does what is missing and ends in the bytes of
// a run that nobody disturbed.
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <regex>
#include <set>

#include "tests/pipeline/run/label_volumes.h"
#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;

// One thread: each run comes by the same points in the same order.
Settings in_order(const Settings& settings) {
  return settings + Settings{"run.threads=1"};
}

// The moments before and after each change of a run's files, as commit_points.cpp names them.
std::vector<std::string> points_of(const Scene& scene, const Settings& settings) {
  const fs::path list = scene.directory() / "points";
  fs::remove(list);
  const Environment listed = watched(scene, {{"VOXWELD_POINTS_LIST", list}});
  VOXWELD_EXPECT_DONE(scene.run(in_order(settings)));
  std::vector<std::string> points;
  std::ifstream in(list);
  for (std::string line; std::getline(in, line);) points.push_back(line);
  return points;
}

// Of points that only differ in their numbers, the tiles' say, the first and the last.
std::vector<std::string> of_each_kind(const std::vector<std::string>& points) {
  std::map<std::string, std::set<std::size_t>> kinds;
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::set<std::size_t>& same = kinds[std::regex_replace(points[i], std::regex("[0-9]+"), "#")];
    if (same.size() == 2) same.erase(std::prev(same.end()));
    same.insert(i);
  }
  std::set<std::size_t> chosen;
  for (const auto& [kind, same] : kinds) chosen.insert(same.begin(), same.end());
  std::vector<std::string> some;
  for (const std::size_t i : chosen) some.push_back(points[i]);
  return some;
}

ProgramResult run_up_to(const Scene& scene, const Settings& settings, const std::string& point,
                        int signal) {
  const Environment stopped = watched(
      scene, {{"VOXWELD_POINTS_AT", point}, {"VOXWELD_POINTS_SIGNAL", std::to_string(signal)}});
  return scene.run(in_order(settings));
}

void start_again(const Scene& scene) {
  scene.forget();
}

void expect_whole(const Scene& scene, const Tree& clean) {
  EXPECT_EQ(difference(clean, output_tree(scene.output())), "");
  EXPECT_TRUE(temporary_files(scene.work()).empty());
  EXPECT_TRUE(temporary_files(scene.output()).empty());
}

struct Kills {
  Settings settings;
  std::vector<std::string> of;  // what is certainly changed: the ends of points
  std::string within = {};      // only points that have this in them
  Settings before = {};         // of the run whose files are there already; empty: none
};

// Kills the run at the points of an undisturbed one, each time going on from where the last was
// killed, so that whatever a kill spoils is there at the end.
void expect_whole_after(const Kills& kills, const Scene& scene) {
  const auto prepare = [&] {
    start_again(scene);
    if (!kills.before.empty()) VOXWELD_EXPECT_DONE(scene.run(kills.before));
  };
  const Tree clean = scene.clean_tree(kills.settings);
  prepare();
  std::vector<std::string> points = of_each_kind(points_of(scene, kills.settings));
  std::erase_if(points, [&](const std::string& point) {
    return point.find(kills.within) == std::string::npos;
  });
  for (const std::string& change : kills.of)
    for (const char* moment : {"before ", "after "})
      EXPECT_TRUE(std::ranges::any_of(points,
                                      [&](const std::string& point) {
                                        return point.starts_with(moment) && point.ends_with(change);
                                      }))
          << "no point " << moment << change;
  prepare();
  for (const std::string& point : points)
    ASSERT_EQ(run_up_to(scene, kills.settings, point, SIGKILL).exit_code, 128 + SIGKILL)
        << "not killed " << point;
  VOXWELD_EXPECT_DONE(scene.run(kills.settings));
  expect_whole(scene, clean);
}

TEST(Kill, AtEachCommitOfARunThroughTheStore) {
  const Settings settings = {"work.brick=16", "work.shard=2", "work.copy=true",
                             "output.tile_vertices=2000"};
  expect_whole_after({settings,
                      {"last-run.toml", "zarr.json", "0/0/0", ".shard", ".octree", "top.tree",
                       ".tile", "unfinished.files", "-0.drc", "-0.glb", "-0.record", "mesh.drc",
                       "mesh.glb", "merged.record", "tiles.jsonl", "manifest.json"}},
                     Scene(noise_volume({20, 34, 18}, 2)));
}

// A stream is spooled first: one more file that may be cut short.
TEST(Kill, AtEachCommitOfTheIngestOfACompressedVolume) {
  const RawVolume volume = noise_volume({20, 18, 15}, 4);
  const Scene scene("sphere", 8);  // its volume makes room for another one
  const fs::path path = scene.volume();
  const std::string header =
      "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 20 18 15\nspacings: 1 1 1\nencoding: gzip\n\n";
  std::ofstream(path) << header;
  gzFile out = gzopen(path.c_str(), "ab");
  ASSERT_NE(out, nullptr);
  gzwrite(out, volume.samples.data(), static_cast<unsigned>(volume.samples.size()));
  gzclose(out);
  const Settings settings = {"surface.isovalue=128", "work.brick=16", "work.shard=2",
                             "simplify.tolerance=2"};
  expect_whole_after({settings, {".raw", ".raw.record", "zarr.json", ".shard"}, "/ingest-"}, scene);
}

TEST(Kill, AtEachCommitOfEachLabel) {
  const Settings settings = {"work.brick=16", "work.shard=2", "labels.mode=each"};
  expect_whole_after({settings,
                      {".labels", "labels.all", ".octree", "top.tree", ".tile", ".record",
                       "labels.jsonl", "tiles.jsonl", "manifest.json"}},
                     Scene(ball_labels(SampleType::u8, {20, 20, 34})));
}

TEST(Kill, AtEachCommitOfARefinedRun) {
  const Settings settings = {"work.brick=16", "work.shard=2", "output.tile_vertices=1024",
                             "simplify.refine=collapse"};
  expect_whole_after({settings, {".cubes", "tile.plan", ".tile", ".record", "manifest.json"}},
                     Scene("porous", 80));
}

// Other tiles in one format less: what the run before left must be known until it is removed.
TEST(Kill, AtEachCommitOfAChangedRun) {
  const Settings before = {"work.brick=16", "output.tile_vertices=1024"};
  const Settings after = {"work.brick=16", "simplify.tolerance=0.4", "output.formats=[\"drc\"]"};
  expect_whole_after(
      {after,
       {"top.tree", "-0.drc", "rename /scene.mesh/manifest.json",
        "removal /scene.mesh/manifest.json", "removal /scene.mesh/mesh.glb", "unfinished.files"},
       "",
       before},
      Scene("part", 40));
}

// Between the points too: at random moments of the time a whole run takes.
TEST(Kill, AtRandomMoments) {
  const Scene scene("porous", 64);
  const Settings settings = {"work.brick=16", "work.shard=2", "work.copy=true",
                             "output.tile_vertices=1024"};
  const Tree clean = scene.clean_tree(settings);
  const ProgramResult undisturbed = scene.run(settings);
  VOXWELD_EXPECT_DONE(undisturbed);
  start_again(scene);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> moment(0, undisturbed.seconds);
  constexpr int wanted = 4;
  int kills = 0;
  for (int tries = 0; kills < wanted && tries < 10 * wanted; ++tries) {
    const ProgramResult result = scene.run(settings, Stop{SIGKILL, moment(random)});
    if (result.exit_code == 128 + SIGKILL) {
      ++kills;
      continue;
    }
    VOXWELD_EXPECT_DONE(result);  // it was done before the moment came
    start_again(scene);
  }
  EXPECT_EQ(kills, wanted);
  VOXWELD_EXPECT_DONE(scene.run(settings));
  expect_whole(scene, clean);
}

TEST(Kill, CtrlCEndsWithAMessageAndResumes) {
  const Scene scene("part", 40);
  const Settings settings = {"work.brick=16", "work.shard=2"};
  const Tree clean = scene.clean_tree(settings);
  const auto points = points_of(scene, settings);
  const auto octree = std::ranges::find_if(
      points, [](const std::string& point) { return point.ends_with(".octree"); });
  ASSERT_NE(octree, points.end());
  start_again(scene);
  const ProgramResult result = run_up_to(scene, settings, *octree, SIGINT);
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("interrupted; what is finished is kept"), std::string::npos)
      << result.err;
  EXPECT_TRUE(temporary_files(scene.work()).empty());
  EXPECT_FALSE(fs::exists(scene.output() / "manifest.json"));
  VOXWELD_EXPECT_DONE(scene.run(settings));
  expect_whole(scene, clean);
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

// Ctrl-C while meshes are read, drawn, converted or checked: no result, and no long wait for it.
TEST(Interrupted, WhatReadsMeshesEndsSoonAndLeavesNothing) {
  const Scene scene("gyroid", 96);
  VOXWELD_EXPECT_DONE(scene.run({"output.tile_vertices=20000"}));
  const fs::path made = scene.directory() / "made";
  const auto in = [&](const char* name) { return (made / name).string(); };
  for (const Arguments& command :
       {Arguments{"verify", scene.output().string()},
        {"render", scene.output().string(), "-o", in("a.png"), "--width", "2000"},
        {"report", scene.output().string(), "-o", in("a.html")},
        {"export", (scene.output() / "mesh.drc").string(), "-o", in("a.obj")},
        {"export", scene.output().string(), "--weld", "-o", in("a.ply")}}) {
    SCOPED_TRACE(command.front() + command.back());
    fs::create_directories(made);
    const ProgramResult whole = run_voxweld(command);
    VOXWELD_EXPECT_DONE(whole);
    int interrupted = 0;
    for (int part = 1; part < 8 && interrupted < 2; ++part) {
      fs::remove_all(made);
      fs::create_directories(made);
      const double after_s = whole.seconds * part / 8;
      const ProgramResult result = run_voxweld(command, Stop{SIGINT, after_s});
      if (result.exit_code == 0 || result.exit_code == 128 + SIGINT) continue;  // too late or early
      ++interrupted;
      EXPECT_EQ(result.exit_code, 1);
      expect_says(result, "error: interrupted");
      EXPECT_LT(result.seconds, after_s + 3);
      EXPECT_TRUE(fs::is_empty(made));
    }
    EXPECT_GT(interrupted, 0);
  }
}

}  // namespace
}  // namespace voxweld::testing
