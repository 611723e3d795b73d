// `voxweld plan`: what it says beforehand, against what a run then leaves.
#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

nlohmann::json plan_of(const Scene& scene, const Settings& settings) {
  const ProgramResult result =
      scene.command_with("plan", settings + scene.in("planned"), {"--json"});
  VOXWELD_EXPECT_DONE(result);
  return nlohmann::json::parse(result.out);
}

nlohmann::json stage_of(const nlohmann::json& plan, const std::string& name) {
  for (const auto& stage : plan.at("stages"))
    if (stage.at("stage") == name) return stage;
  ADD_FAILURE() << "no stage " << name;
  return {};
}

std::uint64_t bytes_of(const std::vector<std::filesystem::path>& files) {
  std::uint64_t bytes = 0;
  for (const auto& file : files) bytes += std::filesystem::file_size(file);
  return bytes;
}

TEST(Plan, ComesNearWhatARunLeaves) {
  const Scene scene("porous", 100);
  const Settings settings = {"work.brick=16", "work.shard=2", "output.tile_vertices=20000"};
  const nlohmann::json plan = plan_of(scene, settings);
  EXPECT_FALSE(std::filesystem::exists(scene.work("planned")));  // nothing is written
  EXPECT_EQ(plan.at("bricks"), 343);
  VOXWELD_EXPECT_DONE(scene.run_in("planned", settings + Settings{"work.copy=true"}));
  const auto manifest = manifest_of(scene.output("planned"));
  const auto near = [](double planned, double real) {
    EXPECT_GT(planned, 0.6 * real);
    EXPECT_LT(planned, 1.7 * real);
  };
  near(plan.at("vertices"), manifest.at("counts").at("vertices"));
  const auto octrees = files_ending(scene.work("planned"), ".octree");
  EXPECT_EQ(stage_of(plan, "build").at("units"), octrees.size());
  near(stage_of(plan, "build").at("disk_bytes"), static_cast<double>(bytes_of(octrees)));
  const auto tiles = files_ending(scene.work("planned"), ".tile");
  near(stage_of(plan, "stitch").at("disk_bytes"), static_cast<double>(bytes_of(tiles)));
  EXPECT_EQ(stage_of(plan, "ingest").at("units"),
            files_ending(scene.work("planned"), ".shard").size());
}

TEST(Plan, ChoosesTheIsovalueFromWhatItSees) {
  const Scene scene("porous", 64);
  const nlohmann::json plan = plan_of(scene, {"surface.isovalue=otsu"});
  EXPECT_GT(plan.at("bricks_looked_at"), 0);
  EXPECT_GT(plan.at("vertices"), 100);
}

TEST(Plan, AsksForTasksThatFitTheConfig) {
  const Scene scene("porous", 100);
  const Settings small = {"work.brick=16", "work.shard=1", "work.chunk=16",
                          "slurm.shards_per_task=10"};
  const nlohmann::json plan = plan_of(scene, small);
  const nlohmann::json build = stage_of(plan, "build");
  EXPECT_EQ(build.at("units"), 343);
  EXPECT_EQ(build.at("tasks"), 35);
  EXPECT_GT(plan.at("task_bytes"), std::uint64_t{4} << 30);
}

}  // namespace
}  // namespace voxweld::testing
