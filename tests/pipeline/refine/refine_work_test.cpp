// The work of refine: stages by themselves, in shares, gone on with, damaged, after edits.
#include "tests/pipeline/refine/refine_work.h"

namespace voxweld::testing {
namespace {

const Settings settings = {"simplify.refine=collapse", "work.brick=16", "work.shard=2",
                           "output.tile_vertices=1024"};

TEST(RefineWork, StageByStage) {
  const Scene scene("porous", 72);
  const Tree clean = scene.clean_tree(settings);
  for (const char* stage : {"ingest", "build", "merge", "stitch", "refine", "seams", "mend",
                            "remend", "retile", "encode"}) {
    const ProgramResult before = scene.command_with("run", settings, {"--dry-run"});
    VOXWELD_EXPECT_DONE(before);
    VOXWELD_EXPECT_DONE(scene.command(stage, settings));
  }
  EXPECT_EQ(difference(clean, output_tree(scene.output())), "");
  const ProgramResult after = scene.command_with("run", settings, {"--dry-run"});
  EXPECT_EQ(after.out.find("would run"), std::string::npos) << after.out;
  const ProgramResult status = scene.command("status", settings);
  EXPECT_NE(status.out.find("finished"), std::string::npos) << status.out;
  EXPECT_NE(status.out.find("ranges"), std::string::npos) << status.out;
}

TEST(RefineWork, AStageThatComesTooEarlySaysWhatIsMissing) {
  const Scene scene("porous", 70);
  VOXWELD_EXPECT_DONE(scene.command("build", settings));
  VOXWELD_EXPECT_DONE(scene.command("merge", settings));
  expect_refused(scene.command("refine", settings), "`voxweld stitch CONFIG`");
  expect_refused(scene.command_with("refine", settings, {"--part", "0/2"}),
                 "`voxweld stitch CONFIG`");
  VOXWELD_EXPECT_DONE(scene.command("stitch", settings));
  expect_refused(scene.command_with("seams", settings, {"--ranges", "0"}),
                 "`voxweld refine CONFIG`");
  expect_refused(scene.command_with("refine", settings, {"--ranges", "99"}), "stage refine has");
}

void expect_shares_are_the_whole(const Scene& scene, const Settings& of) {
  const Tree clean = scene.clean_tree(of);
  for (const char* stage : {"ingest", "build", "merge"})
    VOXWELD_EXPECT_DONE(scene.command(stage, of));
  for (const char* stage : {"stitch", "refine", "seams", "mend", "remend", "retile", "encode"})
    for (const char* part : {"2/3", "0/3", "1/3"})
      VOXWELD_EXPECT_DONE(scene.command_with(stage, of, {"--part", part}));
  VOXWELD_EXPECT_DONE(scene.command("encode", of));
  EXPECT_EQ(difference(clean, output_tree(scene.output())), "");
  for (const auto& [stage, ran] : units_run(scene.output())) EXPECT_EQ(ran, 0u) << stage;
  EXPECT_TRUE(temporary_files(scene.work()).empty());
}

TEST(RefineWork, AllSharesAreTheWhole) {
  expect_shares_are_the_whole(Scene("porous", 72), settings);
}
TEST(RefineWork, AllSharesBetweenLabelsAreTheWhole) {
  const Scene scene(volume_of({96, 90, 80}, [](Index3 at) {
    return 1 + (at.x + at.z / 3) / 23 + 10 * ((at.y + at.x / 5) / 19);
  }));
  expect_shares_are_the_whole(scene, settings + Settings{"labels.mode=shared"});
}

TEST(RefineWork, GoesOnWhereItStopped) {
  const Scene scene("porous", 72);
  expect_goes_on(scene, settings, scene.clean_tree(settings), refine_stages);
}

TEST(RefineWork, DamageIsFoundAndMended) {
  expect_damage_is_mended(Scene("porous", 72), settings, 1, refine_artifacts);
}

// Three cubes a side, the last of them of the ring's alone.
TEST(RefineWork, AnEditReachesFewUnits) {
  const Scene scene("gyroid", 128);
  const EditScene edits(scene);
  VOXWELD_EXPECT_DONE(scene.run(settings));
  const auto all = units_run(scene.output());
  edits.set(ball("add", {16, 16, 16}, 9));  // inside one cube of either pass
  VOXWELD_EXPECT_DONE(scene.run(settings));
  auto units = units_run(scene.output());
  for (const std::string stage : {"stitch", "refine", "seams", "retile"}) {
    EXPECT_GT(units[stage], 0u) << stage;
    EXPECT_LT(units[stage], all.at(stage) / 3) << stage;
  }
  for (const std::string stage : {"mend", "remend"})
    EXPECT_LT(units[stage], all.at(stage) / 3) << stage;  // none but of what intersects
  EXPECT_EQ(difference(scene.clean_tree(settings), output_tree(scene.output())), "");
}

TEST(RefineWork, CleanKeepsWhatIsInUse) {
  const Scene scene("porous", 64);
  VOXWELD_EXPECT_DONE(scene.run());
  VOXWELD_EXPECT_DONE(scene.run(settings));
  VOXWELD_EXPECT_DONE(scene.command("clean", settings));
  VOXWELD_EXPECT_DONE(scene.run(settings));
  for (const auto& [stage, ran] : units_run(scene.output())) EXPECT_EQ(ran, 0u) << stage;
}

}  // namespace
}  // namespace voxweld::testing
