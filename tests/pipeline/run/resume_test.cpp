// Resume is precise: a run does what is missing or follows from a change, and nothing else.

#include <fstream>

#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;
using Units = std::map<std::string, std::uint64_t>;

const std::vector<std::string> stages = {"ingest", "build", "merge", "stitch", "encode"};

// What a dry run says of each stage.
std::map<std::string, std::string> dry_run(const Scene& scene, const Settings& settings) {
  const ProgramResult result = scene.command_with("run", settings, {"--dry-run"});
  VOXWELD_EXPECT_DONE(result);
  std::map<std::string, std::string> said;
  std::istringstream lines(result.out);
  for (std::string line; std::getline(lines, line);)
    said[line.substr(0, line.find(' '))] = line.substr(std::min<std::size_t>(line.size(), 8));
  EXPECT_EQ(said.size(), stages.size()) << result.out;
  return said;
}

bool would_run(const std::string& said) {
  return said.starts_with("would run");
}

// The scene is up to date with `before`; runs with `after`. The stages from `first` on must run and
// none before it, the dry run must say so and name `reason`, and the bytes must be a clean run's.
void expect_runs_from(const Scene& scene, const Settings& before, const Settings& after,
                      const std::string& first, const std::string& reason) {
  SCOPED_TRACE(reason + " re-runs " + first);
  VOXWELD_EXPECT_DONE(scene.run(before));
  const auto said = dry_run(scene, after);
  VOXWELD_EXPECT_DONE(scene.run(after));
  Units ran = units_run(scene.output());
  bool from_here = false;
  for (const std::string& stage : stages) {
    from_here = from_here || stage == first;
    EXPECT_EQ(ran[stage] > 0, from_here) << stage << " ran " << ran[stage];
    EXPECT_EQ(would_run(said.at(stage)), from_here) << stage << " " << said.at(stage);
  }
  if (!first.empty()) {
    EXPECT_NE(said.at(first).find(reason), std::string::npos) << said.at(first);
  }
  EXPECT_EQ(difference(scene.clean_tree(after), output_tree(scene.output())), "");
}

const Settings copied_store = {"work.brick=16", "work.shard=2", "work.copy=true",
                               "output.tile_vertices=1024"};

TEST(Resume, NothingRunsTwice) {
  const Scene scene("porous", 48);
  for (const char* copy : {"work.copy=false", "work.copy=true"}) {
    const Settings settings = copied_store + Settings{copy};
    VOXWELD_EXPECT_DONE(scene.run(settings));
    const ProgramResult again = scene.command("run", settings);
    VOXWELD_EXPECT_DONE(again);
    for (const auto& [stage, units] : units_run(scene.output())) EXPECT_EQ(units, 0u) << stage;
    for (const auto& [stage, said] : dry_run(scene, settings))
      EXPECT_FALSE(would_run(said)) << said;
  }
}

TEST(Resume, TheManifestIsPrintedAsJson) {
  const Scene scene("sphere", 24);
  const ProgramResult first = run_voxweld({"run", scene.config().string(), "--json"});
  VOXWELD_EXPECT_DONE(first);
  EXPECT_EQ(nlohmann::json::parse(first.out), manifest_of(scene.output()));
}

// Also where nothing was ever sent to a cluster.
TEST(Resume, StatusSaysWhetherALocalRunIsFinished) {
  const Scene scene("porous", 32);
  VOXWELD_EXPECT_DONE(scene.run());
  const ProgramResult done = scene.command("status", {});
  EXPECT_EQ(done.exit_code, 0) << done.out;
  EXPECT_NE(done.out.find("finished"), std::string::npos) << done.out;
  const ProgramResult changed = scene.command("status", {"surface.isovalue=100"});
  EXPECT_EQ(changed.exit_code, 1) << changed.out;
  EXPECT_NE(changed.out.find("not finished"), std::string::npos) << changed.out;
}

TEST(Resume, AChangedSettingRunsItsStageAndThoseAfter) {
  const Scene scene("porous", 48);
  const auto with = [](const std::string& setting) { return copied_store + Settings{setting}; };
  expect_runs_from(scene, copied_store, with("simplify.tolerance=0.3"), "build",
                   "simplify.tolerance was 0.1, is 0.3");
  expect_runs_from(scene, copied_store, with("surface.isovalue=120"), "build",
                   "surface.isovalue was 127.5, is 120");
  expect_runs_from(scene, copied_store, with("output.tile_vertices=3000"), "merge",
                   "output.tile_vertices was 1024, is 3000");
  expect_runs_from(scene, copied_store, with("output.precision=0.1"), "stitch",
                   "output.precision was 0.01, is 0.1");
  expect_runs_from(scene, copied_store, with("output.normals=false"), "stitch",
                   "output.normals was true, is false");
  expect_runs_from(scene, copied_store, with("output.formats=[\"glb\"]"), "encode",
                   "output.formats was");
}

// Samples are the same with any spacing. The store's metadata say the new one.
TEST(Resume, AnotherSpacingOrUnitCopiesNothing) {
  const Scene scene("porous", 48);
  VOXWELD_EXPECT_DONE(scene.run(copied_store));
  for (const auto& [setting, first] :
       {std::pair<std::string, std::string>{"input.spacing=[1, 2, 3]", "build"},
        {"input.unit=nm", "encode"}}) {
    SCOPED_TRACE(setting);
    const Settings settings = copied_store + Settings{setting};
    EXPECT_NE(dry_run(scene, settings).at("ingest").find("zarr.json"), std::string::npos);
    VOXWELD_EXPECT_DONE(scene.run(settings));
    Units ran = units_run(scene.output());
    EXPECT_EQ(ran["ingest"], 0u);
    EXPECT_EQ(ran["build"] > 0, first == "build");
    EXPECT_GT(ran["encode"], 0u);
    EXPECT_EQ(difference(scene.clean_tree(settings), output_tree(scene.output())), "");
    const auto stores = files_ending(scene.work(), "zarr.json");
    ASSERT_EQ(stores.size(), 1U);
    const auto own = nlohmann::json::parse(text_of_file(stores[0])).at("attributes").at("voxweld");
    EXPECT_EQ(own.at("spacing"),
              (first == "build" ? nlohmann::json{1, 2, 3} : nlohmann::json{1, 1, 1}));
    EXPECT_EQ(own.at("unit"), first == "build" ? "" : "nm");
    VOXWELD_EXPECT_DONE(scene.run(copied_store));
  }
}

TEST(Resume, AChangedChunkOfTheStoreRebuildsNothing) {
  const Scene scene("porous", 48);
  VOXWELD_EXPECT_DONE(scene.run(copied_store + Settings{"work.chunk=32"}));
  VOXWELD_EXPECT_DONE(scene.run(copied_store + Settings{"work.chunk=8"}));
  Units ran = units_run(scene.output());
  EXPECT_GT(ran["ingest"], 0u);
  for (const char* stage : {"build", "merge", "stitch", "encode"})
    EXPECT_EQ(ran[stage], 0u) << stage;
}

TEST(Resume, OtherThreadsAndMemoryRunNothing) {
  const Scene scene("porous", 32);
  expect_runs_from(scene, copied_store, copied_store + Settings{"run.threads=1", "run.memory=1GiB"},
                   "", "");
}

TEST(Resume, FormatsLeftOutAreTakenAway) {
  const Scene scene("porous", 32);
  VOXWELD_EXPECT_DONE(scene.run(copied_store));
  EXPECT_GT(files_ending(scene.output(), ".glb").size(), 2u);
  VOXWELD_EXPECT_DONE(scene.run(copied_store + Settings{"output.formats=[\"drc\"]"}));
  EXPECT_TRUE(files_ending(scene.output(), ".glb").empty());
  EXPECT_GT(files_ending(scene.output(), ".drc").size(), 2u);
  VOXWELD_EXPECT_DONE(scene.run(copied_store + Settings{"output.merged=false"}));
  EXPECT_FALSE(fs::exists(scene.output() / "mesh.drc"));
}

TEST(Resume, WhatTheUserPutThereStays) {
  const Scene scene("porous", 32);
  VOXWELD_EXPECT_DONE(scene.run(copied_store));
  const fs::path notes = scene.output() / "tiles" / "notes.glb";
  std::ofstream(notes) << "mine";
  VOXWELD_EXPECT_DONE(scene.run(copied_store + Settings{"output.formats=[\"drc\"]"}));
  EXPECT_TRUE(fs::exists(notes));
}

TEST(Resume, ATouchedInputRebuildsNothing) {
  const Scene scene(noise_volume({30, 30, 30}, 2));
  for (const char* copy : {"work.copy=false", "work.copy=true"}) {
    const Settings settings = copied_store + Settings{copy};
    VOXWELD_EXPECT_DONE(scene.run(settings));
    const Tree before = output_tree(scene.output());
    fs::last_write_time(scene.volume(), fs::file_time_type::clock::now() + std::chrono::hours(1));
    VOXWELD_EXPECT_DONE(scene.run(settings));
    Units ran = units_run(scene.output());
    for (const char* stage : {"build", "merge", "stitch", "encode"})
      EXPECT_EQ(ran[stage], 0u) << stage << " with " << copy;
    EXPECT_EQ(difference(before, output_tree(scene.output())), "");
  }
}

// One sample of the volume turns from outside to inside or back: the shards whose bricks read it
// are built again, no other.
TEST(Resume, AChangedSampleRebuildsTheShardsThatReadIt) {
  RawVolume volume = noise_volume({100, 20, 20}, 9);
  const Scene scene(volume);
  for (const char* copy : {"work.copy=false", "work.copy=true"}) {
    const Settings settings = {"work.brick=16", "work.shard=2", copy};
    scene.write_volume(volume);
    VOXWELD_EXPECT_DONE(scene.run(settings));
    RawVolume changed = volume;
    const auto at = static_cast<std::size_t>(volume.index({80, 10, 10}));  // shard 2 of 4 along x
    changed.samples[at] = changed.samples[at] < std::byte{128} ? std::byte{255} : std::byte{0};
    scene.write_volume(changed);
    VOXWELD_EXPECT_DONE(scene.run(settings));
    EXPECT_EQ(units_run(scene.output())["build"], 1u) << copy;
    EXPECT_EQ(difference(scene.clean_tree(settings), output_tree(scene.output())), "") << copy;
  }
}

// Bricks known to be wholly on one side are not read. When one goes over to the other side, that
// must be noticed all the same: here by the nodes above, which a stale "outside" keeps apart.
TEST(Resume, AnUnreadBrickThatChangesSidesIsNoticed) {
  const auto slab = [](std::int64_t height) {
    return volume_of({132, 132, 132}, [=](Index3 at) { return at.z < height ? 200 : 20; });
  };
  const Settings settings = {"work.brick=16", "work.shard=1", "work.chunk=16", "work.copy=true",
                             "simplify.tolerance=0.5"};
  const Scene scene(slab(71));
  VOXWELD_EXPECT_DONE(scene.run(settings));
  scene.write_volume(slab(119));
  VOXWELD_EXPECT_DONE(scene.run(settings));
  EXPECT_EQ(difference(scene.clean_tree(settings), output_tree(scene.output())), "");
}

TEST(Resume, ADeletedFileComesBack) {
  const Scene scene("porous", 40);
  const Settings both[] = {copied_store, copied_store + Settings{"work.copy=false"}};
  for (const Settings& settings : both) {
    VOXWELD_EXPECT_DONE(scene.run(settings));
    const Tree before = output_tree(scene.output());
    struct Deletion {
      fs::path root;
      const char* ending;
      const char* stage;  // the first that the dry run must name; empty: none
    };
    std::vector<Deletion> deletions = {
        {scene.output(), "mesh.drc", "encode"},      {scene.output(), "0.glb", "encode"},
        {scene.output(), "manifest.json", "encode"}, {scene.output(), "tiles.jsonl", "encode"},
        {scene.work(), "merged.record", "encode"},   {scene.work(), "0-0-0.record", "encode"},
        {scene.work(), ".tile", "stitch"},           {scene.work(), "top.tree", "merge"},
        {scene.work(), ".octree", "build"},
    };
    if (settings == copied_store) {
      deletions.push_back({scene.work(), ".shard", "ingest"});
      deletions.push_back({scene.work(), "zarr.json", "ingest"});
    }
    for (const auto& [root, ending, stage] : deletions) {
      SCOPED_TRACE(ending);
      const auto files = files_ending(root, ending);
      ASSERT_FALSE(files.empty());
      fs::remove(files.back());
      const auto said = dry_run(scene, settings);
      if (*stage != '\0') {
        EXPECT_TRUE(would_run(said.at(stage))) << said.at(stage);
      }
      VOXWELD_EXPECT_DONE(scene.run(settings));
      EXPECT_EQ(difference(before, output_tree(scene.output())), "");
    }
  }
}

TEST(Resume, StagesOneByOneGiveTheSameBytes) {
  const Scene scene("porous", 40);
  for (const Settings& settings : {copied_store, copied_store + Settings{"work.copy=false"}}) {
    scene.forget();
    for (const std::string& stage : stages) VOXWELD_EXPECT_DONE(scene.command(stage, settings));
    EXPECT_EQ(difference(scene.clean_tree(settings), output_tree(scene.output())), "");
    VOXWELD_EXPECT_DONE(scene.run(settings));
    for (const auto& [stage, units] : units_run(scene.output())) EXPECT_EQ(units, 0u) << stage;
  }
}

TEST(Resume, AStageRunTooEarlyNamesTheOneToRun) {
  const Scene scene("porous", 32);
  const Settings settings = copied_store;
  for (std::size_t done = 0; done + 1 < stages.size(); ++done) {
    for (std::size_t early = done + 1; early < stages.size(); ++early) {
      const ProgramResult result = scene.command(stages[early], settings);
      EXPECT_EQ(result.exit_code, 2) << stages[early];
      expect_says(result, "voxweld " + stages[done] + " ");
      EXPECT_FALSE(fs::exists(scene.output()));
    }
    VOXWELD_EXPECT_DONE(scene.command(stages[done], settings));
  }
  VOXWELD_EXPECT_DONE(scene.command(stages.back(), settings));
}

}  // namespace
}  // namespace voxweld::testing
