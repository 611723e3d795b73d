// simplify.triangles and simplify.ratio: so many triangles are left, however the work is cut.
#include <fmt/format.h>

#include <cmath>

#include "tests/pipeline/refine/refine_work.h"
#include "tests/pipeline/run/label_volumes.h"

namespace voxweld::testing {
namespace {

const Settings collapsing = {"simplify.refine=collapse"};
const Settings target_parts = {"work.brick=16", "work.shard=2", "output.tile_vertices=1024"};
const Settings fifth = collapsing + target_parts + Settings{"simplify.ratio=0.2"};
const std::vector<std::string> target_stages = {"survey", "refine", "recount", "seams",
                                                "mend",   "remend", "retile"};

nlohmann::json target_of(const Scene& scene) {
  return manifest_of(scene.output()).at("refine").at("target");
}
std::uint64_t triangles_left(const Scene& scene) {
  return manifest_of(scene.output()).at("counts").at("triangles").get<std::uint64_t>();
}

// At most, and hardly fewer.
void expect_near(const Scene& scene, double wanted) {
  const auto left = static_cast<double>(triangles_left(scene));
  EXPECT_LT(std::abs(left - wanted), 0.03 * wanted + 8) << left << " for " << wanted;
  expect_good(scene.output());
  EXPECT_EQ(manifest_of(scene.output()).at("refine").at("intersecting_left"), 0);
}

TEST(Target, OfARatioIsMet) {
  for (const char* phantom : {"part", "torus"}) {
    const Scene scene(phantom, 72);
    VOXWELD_EXPECT_DONE(scene.run());
    const auto plain = static_cast<double>(triangles_left(scene));
    for (const double ratio : {0.7, 0.3, 0.1}) {
      SCOPED_TRACE(fmt::format("{} {}", phantom, ratio));
      VOXWELD_EXPECT_DONE(
          scene.run(collapsing + Settings{fmt::format("simplify.ratio={}", ratio)}));
      expect_near(scene, ratio * plain);
      EXPECT_EQ(target_of(scene).at("before"), static_cast<std::uint64_t>(plain));
      EXPECT_TRUE(target_of(scene).at("reached").get<bool>());
    }
  }
}

TEST(Target, OfANumberIsMet) {
  const Scene scene("part", 80);
  for (const int triangles : {3000, 900}) {
    SCOPED_TRACE(triangles);
    const ProgramResult result =
        scene.run(collapsing + Settings{fmt::format("simplify.triangles={}", triangles)});
    VOXWELD_EXPECT_DONE(result);
    expect_near(scene, triangles);
    expect_says(result, fmt::format("seams: {} of", triangles));
  }
}

TEST(Target, IsTheSameWhateverThePartition) {
  const Scene scene("porous", 64);
  const std::vector<Settings> variants = {
      {"work.brick=16", "work.shard=2", "run.threads=1"},
      {"work.brick=32", "work.shard=1", "run.threads=3"},
      {"work.brick=128", "work.shard=1", "work.copy=true", "work.chunk=16", "run.memory=64GiB"}};
  for (const char* ratio : {"0.4", "0.1"})
    scene.expect_one_tree(
        collapsing + Settings{"output.tile_vertices=3000", std::string("simplify.ratio=") + ratio},
        variants);
  // Tiles decide where the mesh is cut and no more.
  std::set<std::uint64_t> counts;
  for (const char* vertices : {"1024", "500000"}) {
    VOXWELD_EXPECT_DONE(
        scene.run(collapsing +
                  Settings{"simplify.ratio=0.1", std::string("output.tile_vertices=") + vertices}));
    counts.insert(triangles_left(scene));
  }
  EXPECT_EQ(counts.size(), 1u);
}

TEST(Target, AboveWhatThereIsLeavesAlmostAll) {
  const Scene scene("gyroid", 32);
  for (const char* target : {"simplify.ratio=1", "simplify.triangles=1000000"}) {
    const ProgramResult result = scene.run(collapsing + Settings{target});
    VOXWELD_EXPECT_DONE(result);
    const auto before = target_of(scene).at("before").get<std::uint64_t>();
    EXPECT_LE(triangles_left(scene), before);
    EXPECT_GT(triangles_left(scene), before * 98 / 100);
    EXPECT_TRUE(target_of(scene).at("reached").get<bool>());
    expect_says(result, "triangles are asked for, and there are");
  }
}

TEST(Target, ThatCannotBeReachedIsTold) {
  const Scene scene("porous", 64);
  const ProgramResult result = scene.run(collapsing + Settings{"simplify.triangles=4"});
  VOXWELD_EXPECT_DONE(result);
  expect_says(result, "simplify.triangles: 4 triangles are asked for");
  EXPECT_FALSE(target_of(scene).at("reached").get<bool>());
  EXPECT_LT(triangles_left(scene), target_of(scene).at("before").get<std::uint64_t>() / 4);
  expect_good(scene.output());
}

TEST(Target, WhatIsNoneIsRefused) {
  const Scene scene("part", 20);
  for (const char* off :
       {"simplify.refine=off", "simplify.enabled=false", "simplify.topology=free"})
    expect_refused(scene.run({"simplify.refine=auto", off, "simplify.triangles=100"}),
                   "set simplify.refine = \"collapse\"");
  expect_refused(scene.run({"simplify.refine=repair", "simplify.ratio=0.5"}),
                 "simplify.refine = \"collapse\"");
  expect_refused(scene.run(collapsing + Settings{"simplify.triangles=100", "simplify.ratio=0.5"}),
                 "remove one of the two");
  for (const char* wrong : {"simplify.ratio=0", "simplify.ratio=1.1", "simplify.ratio=-1"})
    expect_refused(scene.run(collapsing + Settings{wrong}), "a number above 0, at most 1");
  expect_refused(scene.run(collapsing + Settings{"simplify.triangles=0"}), "of at least 1");
  for (const char* stage : {"survey", "recount"}) {
    expect_refused(scene.command(stage), std::string("has no stage ") + stage);
    expect_refused(scene.command(stage, collapsing),
                   "neither simplify.triangles nor simplify.ratio");
  }
}

TEST(Target, OfLabelsIsThatOfAllTogether) {
  const Scene scene(cell_labels({60, 50, 46}, 8, 0, 4));
  for (const char* mode : {"each", "shared"})
    for (const char* ratio : {"0.5", "0.15"}) {
      SCOPED_TRACE(fmt::format("{} {}", mode, ratio));
      const Settings asked = collapsing + Settings{std::string("labels.mode=") + mode,
                                                   std::string("simplify.ratio=") + ratio,
                                                   "output.tile_vertices=1500"};
      scene.expect_one_tree(asked, {{"work.brick=16", "work.shard=2", "run.threads=1"},
                                    {"work.brick=64", "work.shard=1", "run.threads=3"}});
      VOXWELD_EXPECT_DONE(scene.run(asked));
      const auto wanted = target_of(scene).at("triangles").get<double>();
      const auto left = static_cast<double>(triangles_left(scene));
      EXPECT_LT(std::abs(left - wanted), 0.03 * wanted) << left << " for " << wanted;
      expect_good(scene.output());
    }
}

TEST(TargetWork, AllSharesAreTheWhole) {
  const Scene scene("porous", 70);
  const Tree clean = scene.clean_tree(fifth);
  for (const char* stage : {"ingest", "build", "merge"})
    VOXWELD_EXPECT_DONE(scene.command(stage, fifth));
  expect_refused(scene.command_with("refine", fifth, {"--part", "0/2"}), "CONFIG` first");
  for (const char* stage :
       {"stitch", "survey", "refine", "recount", "seams", "mend", "remend", "retile", "encode"}) {
    const ProgramResult before = scene.command_with("run", fifth, {"--dry-run"});
    EXPECT_NE(before.out.find("would run"), std::string::npos) << before.out;
    for (const char* part : {"2/3", "0/3", "1/3"})
      VOXWELD_EXPECT_DONE(scene.command_with(stage, fifth, {"--part", part}));
  }
  VOXWELD_EXPECT_DONE(scene.command("encode", fifth));
  EXPECT_EQ(difference(clean, output_tree(scene.output())), "");
  for (const auto& [stage, ran] : units_run(scene.output())) EXPECT_EQ(ran, 0u) << stage;
  EXPECT_TRUE(temporary_files(scene.work()).empty());
  const ProgramResult status = scene.command("status", fifth);
  EXPECT_NE(status.out.find("recount"), std::string::npos) << status.out;
  VOXWELD_EXPECT_DONE(scene.command("clean", fifth));
  VOXWELD_EXPECT_DONE(scene.run(fifth));
  for (const auto& [stage, ran] : units_run(scene.output())) EXPECT_EQ(ran, 0u) << stage;
}

TEST(TargetWork, GoesOnWhereItStopped) {
  const Scene scene("porous", 70);
  expect_goes_on(scene, fifth, scene.clean_tree(fifth), target_stages);
}

// What is counted holds for any number.
TEST(TargetWork, AnotherNumberSurveysNothingAnew) {
  const Scene scene("part", 80);
  VOXWELD_EXPECT_DONE(scene.run(collapsing + Settings{"simplify.ratio=0.8"}));
  VOXWELD_EXPECT_DONE(scene.run(collapsing + Settings{"simplify.ratio=0.6"}));
  auto units = units_run(scene.output());
  for (const char* stage : {"stitch", "survey"}) EXPECT_EQ(units[stage], 0u) << stage;
  for (const char* stage : {"refine", "recount", "seams"}) EXPECT_GT(units[stage], 0u) << stage;
}

TEST(TargetWork, DamageIsFoundAndMended) {
  const Scene scene("porous", 70);
  expect_damage_is_mended(scene, fifth, 2,
                          {{"survey", ".counts", "refine"},
                           {"recount", ".counts", "seams"},
                           {"refine", "tolerance", "refine"},
                           {"seams", "tolerance", "seams"}});
}

TEST(TargetWork, KilledItLosesNothing) {
  expect_kills_lose_nothing(Scene("porous", 70), fifth, 5, 0.2);
}

// What the edit reaches is surveyed anew and no more. All is refined anew only if the tolerance is
// another then.
TEST(TargetWork, AnEditSurveysFewUnits) {
  const Scene scene("gyroid", 80);
  const EditScene edits(scene);
  const Settings asked = collapsing + target_parts + Settings{"simplify.ratio=0.5"};
  VOXWELD_EXPECT_DONE(scene.run(asked));
  const auto all = units_run(scene.output());
  edits.set(ball("add", {16, 16, 16}, 9));
  VOXWELD_EXPECT_DONE(scene.run(asked));
  auto units = units_run(scene.output());
  EXPECT_GT(units["survey"], 0u);
  EXPECT_LT(units["survey"], all.at("survey") / 3);
  EXPECT_EQ(difference(scene.clean_tree(asked), output_tree(scene.output())), "");
}

TEST(TargetWork, KeepsToItsMemory) {
  const Scene scene("porous", 70);
  const Tree clean = scene.clean_tree(fifth);
  EXPECT_EQ(difference(clean, scene.clean_tree(fifth + Settings{"run.memory=\"200MiB\""})), "");
}

}  // namespace
}  // namespace voxweld::testing
