// Edits with labels.mode = "each": a label's mesh is that of a run of it alone with the edits as it
// has them, and only what they reach is built again.
#include <fmt/format.h>

#include <fstream>
#include <numbers>

#include "tests/pipeline/run/edit_scene.h"
#include "tests/pipeline/run/label_volumes.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;

const Settings parts = {"work.brick=16", "work.shard=2", "output.tile_vertices=1024",
                        "output.formats=[\"drc\"]"};
const Settings each_in_parts = Settings{"labels.mode=each"} + parts;

struct TestEdit {
  std::string op;  // add, subtract, intersect, replace
  std::uint64_t material = 0;
  std::string solid;  // the rest of the table
};

std::string ball_of(Vec3 c, double radius) {
  return fmt::format("shape = \"sphere\"\ncenter = [{}, {}, {}]\nradius = {}\n", c.x, c.y, c.z,
                     radius);
}
std::string block_of(Vec3 c, Vec3 size, const std::string& more = "") {
  return fmt::format("shape = \"box\"\ncenter = [{}, {}, {}]\nsize = [{}, {}, {}]\n{}\n", c.x, c.y,
                     c.z, size.x, size.y, size.z, more);
}

std::string table(const std::string& op, const std::string& more) {
  return "[[edit]]\nop = \"" + op + "\"\n" + more;
}
std::string of_labels(const std::vector<TestEdit>& edits) {
  std::string text;
  for (const TestEdit& edit : edits) {
    const bool gives = edit.op == "add" || edit.op == "replace";
    text +=
        table(edit.op, edit.solid + (gives ? fmt::format("material = {}\n", edit.material) : ""));
  }
  return text;
}
// What the edits are for one label by itself. Precondition: none replaces by it.
std::string of_one(const std::vector<TestEdit>& edits, std::uint64_t label) {
  std::string text;
  for (const TestEdit& edit : edits) {
    const bool takes = edit.op == "replace" || (edit.op == "add" && edit.material != label);
    text += table(takes ? "subtract" : edit.op, edit.solid);
  }
  return text;
}

class EditedLabels {
 public:
  explicit EditedLabels(const RawVolume& volume) : scene_(volume), edits_(scene_) {}
  explicit EditedLabels(Index3 empty) : scene_(noise_volume({2, 2, 2}, 1)), edits_(scene_, empty) {}
  const Scene& scene() const { return scene_; }
  void set(const std::string& edits) const { edits_.set(edits); }

 private:
  const Scene scene_;
  const EditScene edits_;
};

void expect_as_alone(const EditedLabels& labels, const std::vector<TestEdit>& edits,
                     const std::set<std::uint64_t>& of, const Settings& more = {}) {
  const Scene& scene = labels.scene();
  labels.set(of_labels(edits));
  fs::remove_all(scene.output("all"));
  VOXWELD_EXPECT_DONE(scene.run_in("all", each_in_parts + more));
  std::size_t surfaces = 0;
  for (const std::uint64_t label : of) {
    labels.set(of_one(edits, label));
    scene.forget("one");
    const ProgramResult alone =
        scene.run_in("one", parts + more +
                                Settings{fmt::format("surface.label={}", label),
                                         fmt::format("surface.isovalue={}", label)});
    const Tree found = label_files(scene.output("all"), label);
    if (alone.exit_code != 0) {
      expect_says(alone, "no surface");
      EXPECT_TRUE(found.empty()) << label;
      continue;
    }
    ++surfaces;
    EXPECT_EQ(difference(label_files(scene.output("one"), label), found), "") << label;
  }
  EXPECT_EQ(manifest_of(scene.output("all")).at("counts").at("labels"), surfaces);
}

// Reaches some bricks and not others, and labels that end outside their bricks.
const std::vector<TestEdit> mixed_edits = {
    {"add", 3, ball_of({30.2, 20.1, 25.7}, 9.3)},
    {"add", 77, block_of({40, 30, 20}, {15, 18, 12}, "rotate = [33, 0, 12]")},
    {"subtract", 0, ball_of({33, 28, 22}, 6.5)},
    {"intersect", 0, block_of({30, 29, 25.2}, {55, 50, 44})},
    {"add", 3, ball_of({38, 31, 25}, 5)},
};

TEST(EachLabelEdits, GiveTheMeshOfARunOfTheLabelAlone) {
  const RawVolume volume = cell_labels({60, 57, 50}, 6, 0.02, 11);
  std::set<std::uint64_t> labels = labels_of(volume);
  labels.erase(0);
  labels.insert(77);
  expect_as_alone(EditedLabels(volume), mixed_edits, labels);
}

TEST(EachLabelEdits, GiveTheMeshOfARunOfTheLabelAloneInLargeBricks) {
  const RawVolume volume = cell_labels({60, 57, 50}, 3, 0, 15);
  std::set<std::uint64_t> labels = labels_of(volume);
  labels.insert(77);
  expect_as_alone(EditedLabels(volume), mixed_edits, labels,
                  {"work.brick=64", "simplify.tolerance=0.3"});
}

TEST(EachLabelEdits, OfEmptySpaceAreSolidsOfLabels) {
  expect_as_alone(EditedLabels(Index3{60, 57, 50}),
                  {{"add", 5, block_of({30, 29, 25}, {46, 44, 38})},
                   {"add", 9, ball_of({30.2, 20.1, 25.7}, 9.3)},
                   {"subtract", 0, ball_of({33, 28, 22}, 12.5)},
                   {"add", 5, ball_of({5, 5, 5}, 12)},
                   {"add", 11, block_of({30, 29, 25}, {3, 4, 70})}},
                  {5, 9, 11});
}

// What was of any label, cut out of them as one.
TEST(EachLabelEdits, ReplaceTakesWhatIsOfAnyLabel) {
  RawVolume volume = ball_labels(SampleType::u16, {60, 57, 50});
  const EditedLabels labels(volume);
  const Scene& scene = labels.scene();
  const std::string solid = block_of({30, 29, 25.2}, {40, 30, 20}, "rotate = [10, 20, 30]");
  labels.set(of_labels({{"replace", 999, solid}}));
  VOXWELD_EXPECT_DONE(scene.run_in("all", each_in_parts));
  for (std::size_t i = 0; i < volume.samples.size(); i += 2) {
    const bool any = volume.samples[i] != std::byte{0} || volume.samples[i + 1] != std::byte{0};
    volume.samples[i] = std::byte{any};
    volume.samples[i + 1] = std::byte{0};
  }
  scene.write_volume(volume);
  labels.set(table("intersect", solid));
  VOXWELD_EXPECT_DONE(
      scene.run_in("one", parts + Settings{"surface.label=1", "surface.isovalue=1"}));
  EXPECT_EQ(
      difference(label_files(scene.output("one"), 999), label_files(scene.output("all"), 999)), "");
}

// Replacing labels by one of them: as if its voxels had been of it, but for the crossings.
TEST(EachLabelEdits, ReplaceJoinsALabelWithWhatItTakes) {
  RawVolume volume = cell_labels({50, 47, 40}, 4, 0.0, 3);
  const EditedLabels labels(volume);
  const Scene& scene = labels.scene();
  // All of it: one label is left, the whole volume, and its border is where it was.
  labels.set(of_labels({{"subtract", 0, ball_of({20, 20, 20}, 9)},
                        {"replace", 2, block_of({25, 25, 20}, {200, 200, 200})}}));
  VOXWELD_EXPECT_DONE(scene.run_in("all", each_in_parts));
  EXPECT_EQ(manifest_of(scene.output("all")).at("counts").at("labels"), 1);
  expect_good(scene.output("all"));
  for (std::size_t i = 0; i < volume.samples.size(); i += 2) volume.samples[i] = std::byte{2};
  scene.write_volume(volume);
  labels.set(table("subtract", ball_of({20, 20, 20}, 9)));
  VOXWELD_EXPECT_DONE(
      scene.run_in("one", parts + Settings{"surface.label=2", "surface.isovalue=2"}));
  EXPECT_EQ(difference(label_files(scene.output("one"), 2), label_files(scene.output("all"), 2)),
            "");
}

std::map<std::uint64_t, double> volumes(const fs::path& output) {
  std::map<std::uint64_t, double> volumes;
  std::ifstream in(output / "labels.jsonl");
  for (std::string line; std::getline(in, line);) {
    const auto label = nlohmann::json::parse(line);
    volumes[label.at("label")] = label.at("volume");
  }
  return volumes;
}

// The same in both modes; flat faces and sharp edges, so exact but for the output's lattice.
TEST(EachLabelEdits, VolumesAreThoseOfTheSolids) {
  const EditedLabels labels(splat(64));
  const Scene& scene = labels.scene();
  labels.set(of_labels({{"add", 1, block_of({24.3, 25.1, 24.7}, {22, 20, 18})},
                        {"add", 2, block_of({35.3, 35.1, 33.7}, {10, 12, 14})},
                        {"subtract", 0, block_of({24.3, 25.1, 24.7}, {4, 5, 100})},
                        {"replace", 3, block_of({17.3, 25.1, 34.7}, {200, 5, 20})},
                        {"add", 4, ball_of({45.2, 15.4, 40.1}, 11)}}));
  const double of_4 = 4.0 / 3 * std::numbers::pi * 11 * 11 * 11;
  for (const char* mode : {"each", "shared"}) {
    SCOPED_TRACE(mode);
    VOXWELD_EXPECT_DONE(
        scene.run_in(mode, parts + Settings{std::string("labels.mode=") + mode,
                                            "output.precision=0.001", "simplify.tolerance=0.01"}));
    expect_good(scene.output(mode));
    const auto found = volumes(scene.output(mode));
    ASSERT_EQ(found.size(), 4u);
    // 2 took a corner of 5 x 6 x 7 from 1, the hole 4 x 5 x 18, and 3 what is left of 18 x 5 x 9
    // between 24.7 and 33.7.
    EXPECT_NEAR(found.at(2), 10 * 12 * 14, 4);
    EXPECT_NEAR(found.at(3), 18 * 5 * 9, 10);
    EXPECT_NEAR(found.at(1), 22 * 20 * 18 - 5 * 6 * 7 - 4 * 5 * 18 - 18 * 5 * 9, 12);
    EXPECT_NEAR(found.at(4), of_4, 0.005 * of_4);
  }
}

TEST(EachLabelEdits, ComeChangeAndGoAsIfTheyHadBeenThereFromTheStart) {
  const EditedLabels labels(cell_labels({60, 47, 40}, 6, 0, 12));
  const Scene& scene = labels.scene();
  VOXWELD_EXPECT_DONE(scene.run(each_in_parts));
  const Tree before = output_tree(scene.output());
  for (const std::vector<TestEdit>& edits :
       {std::vector<TestEdit>{{"add", 4, ball_of({20, 20, 20}, 6)}}, mixed_edits,
        std::vector<TestEdit>{{"replace", 4, ball_of({20, 20, 20}, 6)}}, std::vector<TestEdit>{}}) {
    labels.set(of_labels(edits));
    VOXWELD_EXPECT_DONE(scene.run(each_in_parts));
    EXPECT_EQ(difference(output_tree(scene.output()), scene.clean_tree(each_in_parts)), "");
  }
  EXPECT_EQ(difference(before, output_tree(scene.output())), "");
}

// Shards of 32 cells, 3 a side and one of the ring.
TEST(EachLabelEdits, OnlyTheShardsTheyReachAreBuiltAgain) {
  const EditedLabels labels(cell_labels({96, 96, 96}, 12, 0, 13));
  const Scene& scene = labels.scene();
  VOXWELD_EXPECT_DONE(scene.run(each_in_parts));
  const auto all = units_run(scene.output());
  labels.set(of_labels({{"add", 500, ball_of({48, 48, 48}, 8)}}));  // inside one shard
  VOXWELD_EXPECT_DONE(scene.run(each_in_parts));
  auto units = units_run(scene.output());
  EXPECT_EQ(units["build"], 1u);
  EXPECT_LT(units["stitch"], all.at("stitch"));
  labels.set(of_labels({{"add", 501, ball_of({48, 48, 48}, 8)}}));
  VOXWELD_EXPECT_DONE(scene.run(each_in_parts));
  EXPECT_EQ(units_run(scene.output())["build"], 1u);
  VOXWELD_EXPECT_DONE(scene.run(each_in_parts));
  EXPECT_EQ(units_run(scene.output())["build"], 0u);
}

TEST(EachLabelEdits, EveryPartitionGivesTheSameBytes) {
  const EditedLabels labels(cell_labels({70, 60, 50}, 5, 0, 14));
  const Scene& scene = labels.scene();
  std::vector<TestEdit> edits = mixed_edits;
  edits.push_back({"replace", 2, ball_of({12, 30, 30}, 15)});
  edits.push_back({"add", 900, block_of({62, 30, 30}, {14, 70, 70})});
  labels.set(of_labels(edits));
  const Settings common = {"labels.mode=each", "output.tile_vertices=1024",
                           "output.formats=[\"drc\"]"};
  scene.expect_one_tree(
      common, {Settings{"work.brick=16", "work.shard=1", "work.chunk=16"},
               Settings{"work.brick=16", "work.shard=4", "run.threads=1"},
               Settings{"work.brick=32", "work.shard=2", "work.copy=true", "work.chunk=8"}});
}

// Labels that were not chosen are nothing; what edits give is there all the same.
TEST(EachLabelEdits, GiveLabelsThatAreNotChosen) {
  const EditedLabels labels(ball_labels(SampleType::u16, {40, 36, 33}));
  const Scene& scene = labels.scene();
  labels.set(
      of_labels({{"add", 12, ball_of({20, 18, 16}, 6)}, {"replace", 7, ball_of({8, 8, 8}, 4)}}));
  for (const char* mode : {"each", "shared"}) {
    VOXWELD_EXPECT_DONE(
        scene.run_in(mode, parts + Settings{std::string("labels.mode=") + mode,
                                            "labels.select=[1, 2]", "labels.min_voxels=2000"}));
    const auto found = volumes(scene.output(mode));
    EXPECT_TRUE(found.contains(12)) << mode;
    EXPECT_FALSE(found.contains(11)) << mode;
    EXPECT_TRUE(verify_output(scene.output(mode)).good()) << mode;
  }
  EXPECT_EQ(volumes(scene.output("each")).size(), volumes(scene.output("shared")).size());
}

TEST(EachLabelEdits, ThatLeaveNothingAreRefused) {
  const EditedLabels labels(ball_labels(SampleType::u16, {20, 20, 20}));
  labels.set(table("subtract", ball_of({10, 10, 10}, 60)));
  const ProgramResult result = labels.scene().run(each_in_parts);
  expect_refused(result, "no surface: after the one edit");
}

}  // namespace
}  // namespace voxweld::testing
