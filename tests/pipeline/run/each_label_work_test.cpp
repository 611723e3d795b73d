// labels.mode = "each" at work: what is done again and what is not, after changes, kills and
// damage.
#include <fmt/format.h>

#include <csignal>
#include <fstream>
#include <functional>

#include "storage/support/file_io.h"
#include "tests/pipeline/run/label_volumes.h"
#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;

const Settings small_batches = {"labels.mode=each", "work.brick=16", "work.shard=2",
                                "output.tile_vertices=1024"};

// Forty regions: several batches, and some labels of several tiles.
RawVolume many_labels() {
  return cell_labels({60, 50, 45}, 40, 0.01, 5);
}

void set_sample(RawVolume& volume, Index3 at, std::uint16_t label) {
  const auto offset = static_cast<std::size_t>(2 * volume.index(at));
  volume.samples[offset] = static_cast<std::byte>(label & 255);
  volume.samples[offset + 1] = static_cast<std::byte>(label >> 8);
}

TEST(EachLabelWork, NothingIsDoneTwice) {
  const Scene scene(many_labels());
  VOXWELD_EXPECT_DONE(scene.run(small_batches));
  const Tree first = output_tree(scene.output());
  VOXWELD_EXPECT_DONE(scene.run(small_batches));
  for (const auto& [stage, ran] : units_run(scene.output())) EXPECT_EQ(ran, 0u) << stage;
  EXPECT_EQ(difference(first, output_tree(scene.output())), "");
}

// A label that is new in one place: the batches of the labels that were there stay.
TEST(EachLabelWork, AChangeRedoesTheLabelsItTouches) {
  RawVolume volume = many_labels();
  const Scene scene(volume);
  VOXWELD_EXPECT_DONE(scene.run(small_batches));
  const auto all = units_run(scene.output());
  for (std::int64_t x = 20; x < 24; ++x) set_sample(volume, {x, 20, 20}, 5000);
  scene.write_volume(volume);
  VOXWELD_EXPECT_DONE(scene.run(small_batches));
  auto again = units_run(scene.output());
  EXPECT_GT(again["stitch"], 0u);
  EXPECT_LT(again["build"], 12u);  // of 12
  EXPECT_LT(again["stitch"], all.at("stitch") / 2);
  EXPECT_LE(again["encode"], again["stitch"]);
  EXPECT_EQ(difference(scene.clean_tree(small_batches), output_tree(scene.output())), "");
  // And back: what the label's meshes were goes.
  scene.write_volume(many_labels());
  VOXWELD_EXPECT_DONE(scene.run(small_batches));
  EXPECT_EQ(difference(scene.clean_tree(small_batches), output_tree(scene.output())), "");
}

// Each change from what is there, as a config is changed.
TEST(EachLabelWork, SettingsRedoWhatReadsThem) {
  const Scene scene(ball_labels(SampleType::u16, {50, 40, 33}));
  VOXWELD_EXPECT_DONE(scene.run(small_batches));
  const auto expect_from = [&](const Settings& more, const std::string& first) {
    SCOPED_TRACE(more.empty() ? "" : more.back());
    VOXWELD_EXPECT_DONE(scene.run(small_batches + more));
    auto ran = units_run(scene.output());
    bool from_here = false;
    for (const char* stage : {"build", "merge", "stitch", "encode"}) {
      from_here = from_here || stage == first;
      EXPECT_EQ(ran[stage] > 0, from_here) << stage;
    }
    EXPECT_EQ(difference(scene.clean_tree(small_batches + more), output_tree(scene.output())), "");
  };
  expect_from({"output.formats=[\"drc\"]"}, "encode");
  expect_from({"output.precision=0.1"}, "stitch");
  expect_from({"output.tile_vertices=2048"}, "merge");
  expect_from({"labels.background=[0, 1]"}, "build");
  expect_from({"labels.mode=shared"}, "build");
  expect_from({"labels.mode=off", "surface.isovalue=0.5"}, "build");
}

TEST(EachLabelWork, NamesAndColoursAreListedAnew) {
  const Scene scene(ball_labels(SampleType::u16, {40, 33, 20}));
  const Settings settings = small_batches + Settings{"output.formats=[\"drc\"]"};
  VOXWELD_EXPECT_DONE(scene.run(settings));
  std::ofstream(scene.directory() / "map.csv")
      << "label,name,color\n1,first,#ff0010\n2,second ball,\n";
  VOXWELD_EXPECT_DONE(
      scene.run(settings + Settings{"labels.map=" + (scene.directory() / "map.csv").string()}));
  for (const char* stage : {"build", "merge", "stitch", "encode"})
    EXPECT_EQ(units_run(scene.output())[stage], 0u) << stage;
  const std::string text = text_of_file(scene.output() / "labels.jsonl");
  EXPECT_NE(text.find("{\"label\":1,\"name\":\"first\",\"color\":[255,0,16],\"vertices\""),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("{\"label\":2,\"name\":\"second ball\",\"vertices\""), std::string::npos);
}

// Only the files that show a name or a colour are written again when it changes.
TEST(EachLabelWork, NamesAndColoursAreEncodedAnewAndNothingElse) {
  const Scene scene(ball_labels(SampleType::u16, {40, 33, 20}));
  const fs::path map = scene.directory() / "map.csv";
  for (const char* mode : {"labels.mode=each", "labels.mode=shared"}) {
    SCOPED_TRACE(mode);
    const Settings plain = small_batches + Settings{mode, "output.tile_vertices=2048"};
    const Settings settings = plain + Settings{"labels.map=" + map.string()};
    VOXWELD_EXPECT_DONE(scene.run(plain));
    const auto encoded = [&](const char* rows) {
      std::ofstream(map) << "label,name,color\n" << rows;
      VOXWELD_EXPECT_DONE(scene.run(settings));
      auto ran = units_run(scene.output());
      for (const char* stage : {"build", "merge", "stitch"}) EXPECT_EQ(ran[stage], 0u) << stage;
      EXPECT_EQ(difference(scene.clean_tree(settings), output_tree(scene.output())), "");
      return ran["encode"];
    };
    EXPECT_GT(encoded("1,first,\n"), 0u);
    const Tree before = output_tree(scene.output());
    EXPECT_GT(encoded("1,first,#ff0010\n"), 0u);
    EXPECT_NE(difference(before, output_tree(scene.output())), "");
    EXPECT_GT(encoded("1,other name,#ff0010\n"), 0u);
    EXPECT_GT(encoded("1,first,#ff0010\n"), 0u);
    EXPECT_EQ(encoded("1,first,#ff0010\n77,not there,#00ff00\n"), 0u);
    EXPECT_GT(encoded("1,first,#ff0011\n"), 0u);
    EXPECT_GT(encoded("1,first,\n"), 0u);
    EXPECT_EQ(difference(before, output_tree(scene.output())), "");
  }
}

TEST(EachLabelWork, KilledItLosesNothing) {
  const Scene scene(many_labels());
  const Tree clean = scene.clean_tree(small_batches);
  const ProgramResult undisturbed = scene.run_in("timing", small_batches);
  VOXWELD_EXPECT_DONE(undisturbed);
  std::mt19937 random(7);
  int killed = 0;
  for (int i = 0; i < 6; ++i) {
    std::uniform_real_distribution<double> moment(0, undisturbed.seconds);
    const ProgramResult result = scene.run(small_batches, Stop{SIGKILL, moment(random)});
    if (result.exit_code == 128 + SIGKILL) {
      ++killed;
    } else {
      VOXWELD_EXPECT_DONE(result);
      fs::remove_all(i % 2 == 0 ? scene.work() : scene.output());
    }
  }
  EXPECT_GT(killed, 0);
  VOXWELD_EXPECT_DONE(scene.run(small_batches));
  EXPECT_EQ(difference(clean, output_tree(scene.output())), "");
  EXPECT_TRUE(temporary_files(scene.work()).empty());
  EXPECT_TRUE(temporary_files(scene.output()).empty());
}

void change_a_bit_of(const fs::path& file, std::mt19937& random) {
  auto bytes = read_whole_file(file);
  if (bytes.empty()) return;
  bytes[random() % bytes.size()] ^= std::byte(1u << (random() % 8));
  write_whole_file(file, bytes, Durability::rename_only);
}
void cut_file(const fs::path& file, std::mt19937& random) {
  auto bytes = read_whole_file(file);
  bytes.resize(random() % std::max<std::size_t>(1, bytes.size()));
  write_whole_file(file, bytes, Durability::rename_only);
}

// What a run would trust it has to read: there everything after build is to be done again.
TEST(EachLabelWork, DamageIsMended) {
  const Scene scene(cell_labels({45, 40, 33}, 12, 0.02, 6));
  VOXWELD_EXPECT_DONE(scene.run(small_batches));
  const Tree clean = output_tree(scene.output());
  std::mt19937 random(8);
  for (const std::string ending : {".octree", "top.tree", ".tile", ".record", ".drc", ".glb",
                                   "manifest.json", "tiles.jsonl", "labels.jsonl"})
    for (const auto& how : {std::function(change_a_bit_of), std::function(cut_file)}) {
      SCOPED_TRACE(ending);
      auto files = files_ending(scene.work(), ending);
      if (files.empty()) files = files_ending(scene.output(), ending);
      ASSERT_FALSE(files.empty());
      how(files[random() % files.size()], random);
      if (ending == ".octree" || ending == "top.tree" || ending == ".tile")
        scene.forget_stages({"merge", "stitch", "encode"});
      const ProgramResult result = scene.run(small_batches);
      VOXWELD_EXPECT_DONE(result);
      EXPECT_EQ(difference(clean, output_tree(scene.output())), "") << result.err;
    }
}

// Of a piece, whose checksum is in the directory alone.
TEST(EachLabelWork, DamageOfAPieceIsNamed) {
  const Scene scene(ball_labels(SampleType::u16, {40, 33, 20}));
  VOXWELD_EXPECT_DONE(scene.run(small_batches));
  const fs::path octree = files_ending(scene.work(), ".octree").at(0);
  auto bytes = read_whole_file(octree);
  bytes[416] ^= std::byte{1};  // behind the header and the first piece's head: its body
  write_whole_file(octree, bytes, Durability::rename_only);
  const ProgramResult result = scene.run(small_batches + Settings{"output.precision=0.1"});
  VOXWELD_EXPECT_DONE(result);
  expect_says(result, octree.string() + ": the checksum of a piece");
  EXPECT_EQ(difference(scene.clean_tree(small_batches + Settings{"output.precision=0.1"}),
                       output_tree(scene.output())),
            "");
}

ProgramResult share(const Scene& scene, const std::string& stage,
                    const std::vector<std::string>& options) {
  return scene.command_with(stage, small_batches + scene.in("shares"), options);
}

TEST(EachLabelWork, AllSharesAreTheWhole) {
  const Scene scene(many_labels());
  const Tree whole = scene.clean_tree(small_batches);
  for (const char* stage : {"ingest", "build", "merge", "stitch", "encode"}) {
    for (int part = 2; part >= 0 && std::string(stage) != "merge"; --part)
      VOXWELD_EXPECT_DONE(share(scene, stage, {"--part", fmt::format("{}/3", part)}));
    VOXWELD_EXPECT_DONE(share(scene, stage, {}));
  }
  EXPECT_EQ(difference(whole, output_tree(scene.output("shares"))), "");
}

// The budget is kept, and a small one is enough for labels whatever their number.
TEST(EachLabelWork, WhatCannotBeIsRefused) {
  const Scene scene(ball_labels(SampleType::u16, {20, 20, 20}));
  const auto refused = [&](const Settings& settings, const std::string& words) {
    const ProgramResult result = scene.run(Settings{"labels.mode=each"} + settings);
    expect_refused(result, words);
  };
  refused({"output.merged=true"}, "output.merged = true: labels.mode = \"each\" writes a mesh for");
  refused({"output.tiles=false", "output.merged=true"}, "output.merged = true");
  refused({"run.memory=\"64MiB\""}, "run.memory");
}

}  // namespace
}  // namespace voxweld::testing
