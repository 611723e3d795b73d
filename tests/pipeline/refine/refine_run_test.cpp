// The refined mesh, end to end: the same however the work is cut, and sound.
#include <fmt/format.h>

#include "tests/pipeline/refine/refine_work.h"

namespace voxweld::testing {
namespace {

const Settings refined = {"simplify.refine=collapse", "simplify.tolerance=0.3"};

class Refined : public ::testing::TestWithParam<const char*> {};

TEST_P(Refined, IsTheSameWhateverThePartition) {
  const Scene scene(GetParam(), 72);
  const Tree tree = scene.expect_one_tree(
      refined + Settings{"output.tile_vertices=2000"},
      {{"work.brick=16", "work.shard=2", "run.threads=1"},
       {"work.brick=32", "work.shard=1", "run.threads=3"},
       {"work.brick=128", "work.shard=1", "work.copy=true", "run.memory=64GiB"}});
  EXPECT_GE(tree.size(), 6u);  // several tiles
}

TEST_P(Refined, IsTheSameWhateverTheTiles) {
  const Scene scene(GetParam(), 72);
  const Tree one = merged_files(scene.clean_tree(refined));
  for (const int vertices : {1024, 3000, 9000})
    EXPECT_EQ(
        difference(one, merged_files(scene.clean_tree(
                            refined + Settings{fmt::format("output.tile_vertices={}", vertices)}))),
        "")
        << vertices;
}

TEST_P(Refined, IsSound) {
  const Scene scene(GetParam(), 72);
  for (const char* mode : {"repair", "collapse"})
    for (const char* border : {"closed", "open"}) {
      SCOPED_TRACE(fmt::format("{} {}", mode, border));
      VOXWELD_EXPECT_DONE(scene.run(refined + Settings{std::string("simplify.refine=") + mode,
                                                       std::string("surface.border=") + border,
                                                       "output.tile_vertices=2000"}));
      const VerifyReport report = expect_good(scene.output());
      EXPECT_GT(report.triangles, 0u);
    }
}

INSTANTIATE_TEST_SUITE_P(Phantoms, Refined, ::testing::Values("gyroid", "part", "porous"),
                         [](const auto& each) { return each.param; });

// An open border that much of the surface comes to. (The solids above keep clear of it.)
class OpenBorder : public ::testing::TestWithParam<const char*> {};

TEST_P(OpenBorder, HasFewerEdgesAndNoTriangleThroughAnother) {
  const bool noise = std::string(GetParam()) == "noise";
  const Scene scene(GetParam(), noise ? 26 : 64);
  const Settings open =
      refined + Settings{"surface.border=open", "output.tile_vertices=2000",
                         noise ? "input.crop=[4,5,6,22,21,20]" : "input.crop=[14,9,12,50,47,53]"};
  VOXWELD_EXPECT_DONE(scene.run(open + Settings{"simplify.refine=off"}));
  const VerifyReport plain = expect_good(scene.output());
  ASSERT_GT(plain.boundary_edges, 200u);
  for (const char* mode : {"repair", "collapse"}) {
    SCOPED_TRACE(mode);
    VOXWELD_EXPECT_DONE(scene.run(open + Settings{std::string("simplify.refine=") + mode}));
    const VerifyReport report = expect_good(scene.output());
    EXPECT_EQ(manifest_of(scene.output()).at("refine").at("intersecting_left"), 0);
    EXPECT_GT(report.boundary_edges, 0u);
    if (std::string(mode) == "collapse") {
      EXPECT_LT(report.boundary_edges, plain.boundary_edges * (noise ? 95 : 75) / 100);
    }
  }
  scene.expect_one_tree(open, {{"work.brick=16", "work.shard=2", "run.threads=1"},
                               {"work.brick=64", "work.shard=1", "run.threads=3"}});
}

INSTANTIATE_TEST_SUITE_P(Phantoms, OpenBorder, ::testing::Values("gyroid", "porous", "noise"),
                         [](const auto& each) { return each.param; });

// Columns of labels that lean within a ball, others around them.
RawVolume leaning_labels(Index3 size) {
  return volume_of(size, [&](Index3 s) {
    const Index3 d = s * 2 - size;
    const bool inside = d.x * d.x + d.y * d.y + d.z * d.z < size.x * size.x;
    return inside ? 1 + (s.x + s.z / 3) / 21 + 10 * ((s.y + s.x / 5) / 17) : s.z / 50;
  });
}

// One complex of all labels.
TEST(RefinedComplex, IsTheSameWhateverThePartition) {
  const Scene scene(leaning_labels({90, 80, 76}));
  const Settings settings = refined + Settings{"labels.mode=shared", "output.tile_vertices=1024"};
  const Tree tree = scene.expect_one_tree(
      settings,
      {{"work.brick=16", "work.shard=2", "run.threads=1"},
       {"work.brick=32", "work.shard=1", "run.threads=3"},
       {"work.brick=128", "work.shard=1", "work.copy=true", "work.chunk=16", "run.memory=64GiB"}});
  EXPECT_GE(tree.size(), 5u);
  const Tree merged = merged_files(tree);
  EXPECT_EQ(
      difference(merged,
                 merged_files(scene.clean_tree(settings + Settings{"output.tile_vertices=3000"}))),
      "");
}

TEST(RefinedComplex, IsSound) {
  const Scene scene(leaning_labels({90, 80, 76}));
  std::uint64_t plain = 0;
  for (const char* mode : {"off", "repair", "collapse"})
    for (const char* border : {"closed", "open"}) {
      SCOPED_TRACE(fmt::format("{} {}", mode, border));
      VOXWELD_EXPECT_DONE(scene.run(
          Settings{std::string("simplify.refine=") + mode, std::string("surface.border=") + border,
                   "simplify.tolerance=0.1", "labels.mode=shared", "output.tile_vertices=1024"}));
      const VerifyReport report = expect_good(scene.output());
      EXPECT_GT(report.seam_vertices, 0u);
      EXPECT_EQ(report.boundary_edges > 0, std::string(border) == "open");
      if (std::string(mode) == "off") plain = report.triangles;
      if (std::string(mode) == "collapse") {
        EXPECT_LT(report.triangles, plain * 3 / 4);
      }
      if (std::string(mode) == "off") continue;
      EXPECT_EQ(manifest_of(scene.output()).at("refine").at("intersecting_left"), 0);
    }
}

// As a mesh whose samples are labels, without normals, with other spacings.
TEST(RefinedKinds, OfALabelAndOfOtherSpacings) {
  RawVolume volume = integer_volume(SampleType::u8, {70, 60, 66}, [](Index3 at) {
    const Index3 d = at - Index3{34, 30, 33};
    return d.x * d.x + 2 * d.y * d.y + d.z * d.z < 700 ? 3 : 0;
  });
  volume.isovalue = 3;  // the label's number
  const Scene scene(volume);
  const Settings settings = refined + Settings{"surface.label=3", "input.spacing=[1, 0.5, 2.25]",
                                               "output.normals=false", "output.tile_vertices=1024"};
  scene.expect_one_tree(settings, {{"work.brick=16", "work.shard=2"}});
  VOXWELD_EXPECT_DONE(scene.run(settings));
  expect_good(scene.output());
}

TEST(RefinedKinds, OfACrop) {
  const Scene scene("gyroid", 96);
  const Settings settings =
      refined + Settings{"input.crop=[5, 9, 3, 90, 80, 96]", "output.tile_vertices=2000"};
  scene.expect_one_tree(settings, {{"work.brick=16", "work.shard=2"}});
  VOXWELD_EXPECT_DONE(scene.run(settings));
  expect_good(scene.output());
}

TEST(RefinedKinds, OffIsAsIfThereWereNone) {
  const Scene scene("part", 48);
  const Tree plain = scene.clean_tree();
  EXPECT_EQ(difference(plain, scene.clean_tree({"simplify.refine=off"})), "");
  EXPECT_EQ(difference(plain, scene.clean_tree({"simplify.intersections=report"})), "");
  VOXWELD_EXPECT_DONE(scene.run());
  EXPECT_FALSE(manifest_of(scene.output()).contains("refine"));
  // And the work of the one is that of the other.
  VOXWELD_EXPECT_DONE(scene.run({"simplify.refine=off"}));
  for (const auto& [stage, ran] : units_run(scene.output())) EXPECT_EQ(ran, 0u) << stage;
}

TEST(RefinedKinds, LeftOpenEdgesAreCollapsedWhereTheTopologyIsKept) {
  const Scene scene("part", 48);
  const auto same = [&](const Settings& common, const char* mode) {
    return difference(scene.clean_tree(common + Settings{std::string("simplify.refine=") + mode}),
                      scene.clean_tree(common + Settings{"simplify.refine=auto"}));
  };
  EXPECT_EQ(same({}, "collapse"), "");
  EXPECT_EQ(same({"simplify.enabled=false"}, "off"), "");
  EXPECT_EQ(same({"simplify.topology=free"}, "off"), "");
  VOXWELD_EXPECT_DONE(scene.run({"simplify.refine=auto"}));
  EXPECT_EQ(manifest_of(scene.output()).at("refine").at("mode"), "collapse");
  // Said or left open, it is the same work.
  VOXWELD_EXPECT_DONE(scene.run({"simplify.refine=collapse"}));
  for (const auto& [stage, ran] : units_run(scene.output())) EXPECT_EQ(ran, 0u) << stage;
}

TEST(RefinedKinds, WhyThereIsNoSuchStage) {
  const Scene scene("part", 20);
  const auto refused = [&](const Settings& settings, const std::string& why) {
    const ProgramResult result = scene.command("mend", settings);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_NE(result.err.find("simplify." + why), std::string::npos) << result.err;
  };
  refused({}, "refine = \"off\": a run");
  refused({"simplify.refine=auto", "simplify.enabled=false"},
          "refine = \"auto\", that is \"off\" with simplify.enabled = false");
  refused({"simplify.refine=auto", "simplify.topology=free"},
          "refine = \"auto\", that is \"off\" with simplify.topology = \"free\"");
  for (const char* rule : {"report", "ignore"})
    refused({"simplify.refine=auto", fmt::format("simplify.intersections={}", rule)},
            fmt::format("intersections = \"{}\": a run", rule));
}

TEST(RefinedKinds, WhatIsOnlyCountedHasNoThirdPass) {
  const Scene scene("part", 128);
  VerifyOptions options;
  options.intersections = true;
  for (const char* rule : {"report", "none"}) {
    SCOPED_TRACE(rule);
    VOXWELD_EXPECT_DONE(
        scene.run({"simplify.refine=repair", fmt::format("simplify.intersections={}", rule)}));
    const bool counted = std::string(rule) == "report";
    for (const char* stage : {"mend", "remend"})
      EXPECT_EQ(units_run(scene.output()).contains(stage), !counted) << stage;
    const std::uint64_t left = manifest_of(scene.output()).at("refine").at("intersecting_left");
    EXPECT_EQ(left > 0, counted);
    EXPECT_EQ(verify_output(scene.output(), options).intersections->pairs, left);
  }
}

TEST(RefinedKinds, TheManifestSaysWhatWasDone) {
  const Scene scene("gyroid", 64);
  const ProgramResult result = scene.run(refined);
  VOXWELD_EXPECT_DONE(result);
  const nlohmann::json manifest = manifest_of(scene.output());
  const nlohmann::json& refine = manifest.at("refine");
  EXPECT_EQ(refine.at("mode"), "collapse");
  EXPECT_GT(refine.at("cubes"), 0);
  EXPECT_EQ(refine.at("unit"), manifest.at("error").at("unit"));
  for (const char* key :
       {"collapses", "moves", "flips", "intersecting_before", "intersecting_left", "worst", "p99"})
    EXPECT_TRUE(refine.contains(key)) << key;
  EXPECT_NE(result.out.find("refined: "), std::string::npos) << result.out;
  const ProgramResult info = run_voxweld({"info", scene.output().string()});
  EXPECT_NE(info.out.find("refine:"), std::string::npos) << info.out;
}

TEST(RefinedKinds, WhatCannotBeRefinedIsRefused) {
  const Scene scene("part", 20);
  expect_refused(scene.run(refined + Settings{"simplify.topology=free"}), "no manifold");
  for (const char* stage : {"refine", "seams", "mend", "remend", "retile"})
    expect_refused(scene.command(stage), std::string("has no stage ") + stage);
}

}  // namespace
}  // namespace voxweld::testing
