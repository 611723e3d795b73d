// The work of refining labels: in shares, gone on with, damaged, killed, after edits.
#include "tests/pipeline/refine/refine_work.h"
#include "tests/pipeline/run/label_volumes.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;

const Settings many_labels = {
    "labels.mode=each", "simplify.refine=collapse",  "simplify.tolerance=0.3",  "work.brick=16",
    "work.shard=2",     "output.tile_vertices=1024", "output.formats=[\"drc\"]"};

// Some labels of several tiles, and balls that are not.
RawVolume label_mix() {
  RawVolume balls = ball_labels(SampleType::u16, {80, 70, 66});
  const RawVolume cells = cell_labels({80, 70, 66}, 5, 0.005, 8);
  for (std::int64_t z = 0; z < 66; ++z)
    for (std::int64_t y = 0; y < 70; ++y)
      for (std::int64_t x = 40; x < 80; ++x)
        for (std::int64_t b = 0; b < 2; ++b) {
          const auto at = static_cast<std::size_t>(2 * balls.index({x, y, z}) + b);
          balls.samples[at] = b == 1 ? std::byte{8} : cells.samples[at];
        }
  return balls;
}

TEST(LabelRefineWork, HasUnitsOfBothKinds) {
  const Scene scene(label_mix());
  VOXWELD_EXPECT_DONE(scene.command("ingest", many_labels));
  VOXWELD_EXPECT_DONE(scene.command("build", many_labels));
  VOXWELD_EXPECT_DONE(scene.command("merge", many_labels));
  expect_refused(scene.command("refine", many_labels), "`voxweld stitch CONFIG`");
  VOXWELD_EXPECT_DONE(scene.command("stitch", many_labels));
  VOXWELD_EXPECT_DONE(scene.command("refine", many_labels));
  std::size_t ranges = 0, batches = 0;
  for (const fs::path& path : files_ending(scene.work(), ".cubes")) {
    if (path.string().find("/refine-") == std::string::npos) continue;
    const ProgramResult info = run_voxweld({"info", path.string(), "--json"});
    const auto labels = nlohmann::json::parse(info.out).at("labels").get<std::uint64_t>();
    ++(labels > 1 ? batches : ranges);
  }
  EXPECT_GT(ranges, 5u);
  EXPECT_GE(batches, 1u);
}

TEST(LabelRefineWork, StageByStageAndInSharesItIsTheSame) {
  const Scene scene(label_mix());
  const Tree clean = scene.clean_tree(many_labels);
  for (const char* stage : {"ingest", "build", "merge"})
    VOXWELD_EXPECT_DONE(scene.command(stage, many_labels));
  for (const char* stage : {"stitch", "refine", "seams", "mend", "remend", "retile", "encode"}) {
    const ProgramResult before = scene.command_with("run", many_labels, {"--dry-run"});
    VOXWELD_EXPECT_DONE(before);
    EXPECT_NE(before.out.find("would run"), std::string::npos) << before.out;
    for (const char* part : {"2/3", "0/3", "1/3"})
      VOXWELD_EXPECT_DONE(scene.command_with(stage, many_labels, {"--part", part}));
  }
  EXPECT_TRUE(temporary_files(scene.work()).empty());
  VOXWELD_EXPECT_DONE(scene.command("encode", many_labels));
  EXPECT_EQ(difference(clean, output_tree(scene.output())), "");
  for (const auto& [stage, ran] : units_run(scene.output())) EXPECT_EQ(ran, 0u) << stage;
  const ProgramResult after = scene.command_with("run", many_labels, {"--dry-run"});
  EXPECT_EQ(after.out.find("would run"), std::string::npos) << after.out;
  const ProgramResult status = scene.command("status", many_labels);
  EXPECT_NE(status.out.find("finished"), std::string::npos) << status.out;
  VOXWELD_EXPECT_DONE(scene.command("clean", many_labels));
  VOXWELD_EXPECT_DONE(scene.run(many_labels));
  for (const auto& [stage, ran] : units_run(scene.output())) EXPECT_EQ(ran, 0u) << stage;
}

TEST(LabelRefineWork, GoesOnWhereItStopped) {
  const Scene scene(label_mix());
  expect_goes_on(scene, many_labels, scene.clean_tree(many_labels), refine_stages);
}

TEST(LabelRefineWork, DamageIsFoundAndMended) {
  const Scene scene(label_mix());
  expect_damage_is_mended(scene, many_labels, 3, refine_artifacts);
}

TEST(LabelRefineWork, KilledItLosesNothing) {
  expect_kills_lose_nothing(Scene(label_mix()), many_labels, 6, 0.1);
}

TEST(LabelRefineWork, AnEditRedoesTheLabelsItTouches) {
  const Scene scene(label_mix());
  const EditScene edits(scene);
  VOXWELD_EXPECT_DONE(scene.run(many_labels));
  const Tree before = output_tree(scene.output());
  const auto all = units_run(scene.output());
  edits.set(ball("add", {8, 8, 8}, 5) + "material = 900\n");  // inside one ball
  VOXWELD_EXPECT_DONE(scene.run(many_labels));
  auto units = units_run(scene.output());
  for (const std::string stage : {"stitch", "refine", "seams", "mend", "retile"}) {
    EXPECT_GT(units[stage], 0u) << stage;
    EXPECT_LT(units[stage], all.at(stage) / 3) << stage;
  }
  EXPECT_EQ(difference(scene.clean_tree(many_labels), output_tree(scene.output())), "");
  edits.set("");
  VOXWELD_EXPECT_DONE(scene.run(many_labels));
  EXPECT_EQ(difference(before, output_tree(scene.output())), "");
}

// A small budget is enough for labels whatever their number, and one that is not is refused.
TEST(LabelRefineWork, KeepsToItsMemory) {
  const Scene scene(label_mix());
  const Tree clean = scene.clean_tree(many_labels);
  EXPECT_EQ(difference(clean, scene.clean_tree(many_labels + Settings{"run.memory=\"200MiB\""})),
            "");
}

}  // namespace
}  // namespace voxweld::testing
