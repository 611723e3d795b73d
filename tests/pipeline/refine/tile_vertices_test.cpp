// How large tiles are: those that merge plans, and those that retile makes of what is refined.
#include <gtest/gtest.h>

#include "pipeline/config/settings.h"
#include "pipeline/run/tile_vertices.h"
#include "pipeline/stage/artifacts.h"
#include "tests/pipeline/refine/refine_work.h"

namespace voxweld::testing {
namespace {

Config refined_config(std::int64_t levels_of_detail, std::int64_t tile_vertices = 0) {
  Config config;
  config.run.memory = std::uint64_t{4} << 30;
  config.simplify.refine = SimplifyConfig::Refine::collapse;
  config.output.levels = levels_of_detail;
  config.output.tile_vertices = tile_vertices;
  fit_tiles(config);
  return config;
}

TEST(TileVertices, OfThePlanDoNotDependOnLevels) {
  EXPECT_EQ(refined_config(1).output.tile_vertices, 250000);
  EXPECT_EQ(planned_tile_vertices(refined_config(1)), 250000);
  EXPECT_EQ(refined_config(0).output.tile_vertices, 65536);
  EXPECT_EQ(planned_tile_vertices(refined_config(0)), 250000);
}

// Or two threads that encode the largest would take more than 256 MB.
TEST(TileVertices, BetweenLabelsAreHalfAsMany) {
  Config config;
  config.run.memory = std::uint64_t{4} << 30;
  config.labels.mode = LabelMode::shared;
  fit_tiles(config);
  EXPECT_EQ(config.output.tile_vertices, 131072);
  EXPECT_EQ(planned_tile_vertices(config), 131072);
  config.output.tile_vertices = 0;
  config.labels.mode = LabelMode::each;
  fit_tiles(config);
  EXPECT_EQ(config.output.tile_vertices, 250000);
}

TEST(TileVertices, AreThoseThatAreAskedFor) {
  const Config config = refined_config(3, 5000);
  EXPECT_EQ(config.output.tile_vertices, 5000);
  EXPECT_EQ(planned_tile_vertices(config), 5000);
}

// Then merge's tiles are those of the output.
TEST(TileVertices, AreTheSameWhereNothingIsRefined) {
  Config config;
  config.run.memory = std::uint64_t{4} << 30;
  config.simplify.refine = SimplifyConfig::Refine::off;
  fit_tiles(config);
  EXPECT_EQ(planned_tile_vertices(config), config.output.tile_vertices);
}

// A run of small tiles and one of large ones differ in all that comes after merge, runs that differ in
// levels only in what is made of the refined mesh.
TEST(TileVertices, TellWhatIsUsedAgain) {
  const auto paths = [](const Config& config) { return stage_paths(config, {}, {}); };
  const StagePaths one = paths(refined_config(1)), many = paths(refined_config(0)),
                   few = paths(refined_config(0, 5000));
  EXPECT_EQ(one.stitch, many.stitch);
  EXPECT_EQ(one.remend, many.remend);
  EXPECT_NE(one.retile, many.retile);
  EXPECT_NE(one.encode, many.encode);
  EXPECT_EQ(one.build, few.build);
  EXPECT_NE(many.merge, few.merge);
  EXPECT_NE(many.retile, few.retile);
  EXPECT_NE(many.levels, few.levels);
}

TEST(TileVertices, LevelsAreMadeOfWhatARunWithoutThemLeft) {
  const Scene scene("gyroid", 72);
  const Settings plain = {"simplify.refine=collapse", "simplify.tolerance=0.05"};
  const Settings leveled = plain + Settings{"output.levels=2"};
  const Tree clean = scene.clean_tree(leveled);
  VOXWELD_EXPECT_DONE(scene.run(plain));
  VOXWELD_EXPECT_DONE(scene.run(leveled));
  EXPECT_EQ(difference(clean, output_tree(scene.output())), "");
  for (const auto& [stage, ran] : units_run(scene.output()))
    EXPECT_EQ(ran > 0, stage == "retile" || stage == "levels" || stage == "encode") << stage;
}

}  // namespace
}  // namespace voxweld::testing
