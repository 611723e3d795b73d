// simplify.refine = "repair": what intersects is mended, and nothing else changes.
#include "stages/refine/refine_range.h"
#include "storage/artifact/cube_mesh_artifact.h"
#include "tests/pipeline/refine/refine_work.h"

namespace voxweld::testing {
namespace {

const Settings repaired = {"simplify.refine=repair"};
const Settings small = repaired + Settings{"output.tile_vertices=2000"};

std::uint64_t pairs_of(const Scene& scene) {
  VerifyOptions options;
  options.intersections = true;
  return verify_output(scene.output(), options).intersections->pairs;
}

RawVolume noise(Index3 size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> any(0, 255);
  return volume_of(size, [&](Index3) { return any(random); });
}

// Here vertices lie exactly where the last cells of the volume end, or beyond that.
TEST(RepairRun, WhatReachesTheFarBorderIsMendedToo) {
  struct Case {
    const char *size, *seed, *tolerance;
  };
  for (const auto& [size, seed, tolerance] :
       {Case{"30", "357", "0.3"}, Case{"33", "260", "0.3"}, Case{"29", "306", "1e9"}}) {
    const Scene scene("porous", 24);
    VOXWELD_EXPECT_DONE(run_voxweld({"phantom", "porous", "--size", size, "--seed", seed, "--type",
                                     "float32", "-o", scene.volume().string(), "--force"}));
    for (const char* mode : {"repair", "collapse"}) {
      SCOPED_TRACE(std::string(size) + " " + mode);
      VOXWELD_EXPECT_DONE(
          scene.run({"surface.isovalue=0", std::string("simplify.tolerance=") + tolerance,
                     std::string("simplify.refine=") + mode}));
      const auto counts = manifest_of(scene.output()).at("refine");
      EXPECT_GT(counts.at("intersecting_before"), 0);
      EXPECT_EQ(counts.at("intersecting_left"), 0);
      EXPECT_EQ(pairs_of(scene), 0u);
    }
  }
}

TEST(RepairRun, IsTheSameHoweverItIsCut) {
  for (const char* phantom : {"part", "porous"}) {
    SCOPED_TRACE(phantom);
    const Scene scene(phantom, 96);
    const Tree tree = scene.expect_one_tree(
        small, {{"work.brick=16", "work.shard=2", "run.threads=1"},
                {"work.brick=32", "work.shard=1", "run.threads=3"},
                {"work.brick=128", "work.shard=1", "work.copy=true", "run.memory=64GiB"}});
    const Tree other = scene.clean_tree(repaired + Settings{"output.tile_vertices=9000"});
    EXPECT_EQ(difference(merged_files(tree), merged_files(other)), "");
  }
}

// More triangles than are done at once, all of which intersect: boxes are cut.
TEST(RepairRun, OfNoiseIsTheSameHoweverItIsCut) {
  const Scene scene(noise({66, 24, 20}, 3));
  const Settings settings = repaired + Settings{"surface.isovalue=120"};
  const Tree tree = scene.expect_one_tree(settings + Settings{"output.tile_vertices=2000"},
                                          {{"work.brick=16", "work.shard=2"}});
  const Tree other = scene.clean_tree(settings + Settings{"output.tile_vertices=60000"});
  EXPECT_EQ(difference(merged_files(tree), merged_files(other)), "");
  VOXWELD_EXPECT_DONE(scene.run(settings));
  const nlohmann::json refine = manifest_of(scene.output()).at("refine");
  EXPECT_GT(refine.at("intersecting_before"), 5000);
  EXPECT_EQ(refine.at("intersecting_left"), 0);
  EXPECT_EQ(pairs_of(scene), 0u);
}

// Boxes of mend are cut too here, and what lies across their borders is left for remend. Seams takes
// nearly all out of what stitch made: mend must not ask for memory for both.
TEST(RepairRun, WhatLiesBetweenBoxesOfMendIsMendedToo) {
  const Scene scene(noise({48, 48, 40}, 3));
  VOXWELD_EXPECT_DONE(
      scene.run(repaired + Settings{"surface.isovalue=120", "work.brick=16",
                                    "output.tile_vertices=8000", "run.memory=132MiB"}));
  std::uint64_t between = 0;
  for (const std::filesystem::path& path : artifacts_of(scene, "mend", ".cubes"))
    between += CubeMeshArtifact(path).counted<RefineCounts>().pairs_left;
  EXPECT_GT(between, 0u);
  EXPECT_EQ(manifest_of(scene.output()).at("refine").at("intersecting_left"), 0);
  EXPECT_EQ(pairs_of(scene), 0u);
}

TEST(RepairRun, OfLabelsIsTheSameHoweverItIsCut) {
  const RawVolume blobs = volume_of({90, 80, 70}, [](Index3 s) {
    const Index3 d = s * 2 - Index3{90, 80, 70};
    return d.x * d.x + d.y * d.y + d.z * d.z < 4900
               ? 1 + (s.x + s.z / 3) / 21 + 10 * ((s.y + s.x / 5) / 17)
               : 0;
  });
  for (const char* mode : {"each", "shared"}) {
    SCOPED_TRACE(mode);
    const Scene scene(blobs);
    const Settings settings = small + Settings{std::string("labels.mode=") + mode};
    scene.expect_one_tree(settings, {{"work.brick=16", "work.shard=2"},
                                     {"work.brick=32", "work.shard=1", "run.threads=3"}});
    VOXWELD_EXPECT_DONE(scene.run(settings));
    expect_good(scene.output());
    EXPECT_EQ(manifest_of(scene.output()).at("refine").at("intersecting_left"), 0);
  }
}

TEST(RepairRun, MendsAllAndLeavesTheRest) {
  const Scene scene("part", 96);
  VOXWELD_EXPECT_DONE(scene.run({"simplify.refine=off"}));
  const std::uint64_t before = pairs_of(scene), triangles = expect_good(scene.output()).triangles;
  EXPECT_GT(before, 20u);
  VOXWELD_EXPECT_DONE(scene.run(repaired));
  // The octrees are those of a mesh that is not refined.
  for (const auto& [stage, ran] : units_run(scene.output()))
    EXPECT_EQ(ran > 0, stage != "ingest" && stage != "build" && stage != "merge") << stage;
  EXPECT_EQ(pairs_of(scene), 0u);
  const nlohmann::json refine = manifest_of(scene.output()).at("refine");
  EXPECT_EQ(refine.at("intersecting_before"), before);
  EXPECT_EQ(refine.at("intersecting_left"), 0);
  std::uint64_t changes = 0;
  for (const char* what : {"moves", "flips", "collapses"})
    changes += refine.at(what).get<std::uint64_t>();
  EXPECT_GT(changes, 0u);
  EXPECT_LT(changes, 4 * before);
  const std::uint64_t left = expect_good(scene.output()).triangles;
  EXPECT_EQ(left, triangles - 2 * refine.at("collapses").get<std::uint64_t>());
}

TEST(RepairRun, OnlyCountedNothingChanges) {
  const Scene scene("part", 96);
  VOXWELD_EXPECT_DONE(scene.run({"simplify.refine=off"}));
  const std::uint64_t before = pairs_of(scene), triangles = expect_good(scene.output()).triangles;
  for (const char* rule : {"report", "ignore"}) {
    SCOPED_TRACE(rule);
    VOXWELD_EXPECT_DONE(
        scene.run(repaired + Settings{std::string("simplify.intersections=") + rule}));
    EXPECT_FALSE(units_run(scene.output()).contains("seams"));
    EXPECT_EQ(expect_good(scene.output()).triangles, triangles);
    EXPECT_EQ(pairs_of(scene), before);
    const nlohmann::json refine = manifest_of(scene.output()).at("refine");
    EXPECT_EQ(refine.at("intersecting_left"), std::string(rule) == "report" ? before : 0);
    expect_refused(
        scene.command("seams", repaired + Settings{std::string("simplify.intersections=") + rule}),
        "has no stage seams");
  }
}

TEST(RepairRun, GoesOnAfterAnyStage) {
  const Scene scene("part", 96);
  expect_goes_on(scene, small, scene.clean_tree(small), refine_stages);
}

TEST(RepairRun, DamageIsMended) {
  const Scene scene("part", 96);
  expect_damage_is_mended(scene, small, 2,
                          {{"stitch", ".cubes", "refine"},
                           {"stitch", ".cubes", "retile"},
                           {"refine", ".cubes", "seams"},
                           {"seams", ".cubes", "mend"},
                           {"mend", ".cubes", "remend"},
                           {"remend", ".cubes", "retile"},
                           {"retile", "tile.plan", "encode"}});
}

TEST(RepairRun, HasLevelsOfDetail) {
  const Scene scene("part", 96);
  const Settings settings = small + Settings{"output.levels=2"};
  scene.expect_one_tree(settings, {{"work.brick=16", "work.shard=2"}});
  VOXWELD_EXPECT_DONE(scene.run(settings));
  expect_good(scene.output());
}

}  // namespace
}  // namespace voxweld::testing
