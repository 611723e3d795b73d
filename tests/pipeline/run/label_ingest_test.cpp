// Labels counted in ingest, and what their rules do to the keys of build: with the program, and
// with its jobs.
#include <fstream>
#include <map>

#include "pipeline/run/jobs.h"
#include "storage/artifact/label_counts.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;

// The label of each sample; cubes of 9 a side, of different numbers, and single samples.
std::int64_t label_at(Index3 at) {
  if ((at.x * 7 + at.y * 5 + at.z * 3) % 41 == 0) return 100 + at.x % 9;
  const Index3 cube{at.x / 9, at.y / 9, at.z / 9};
  return (cube.x + 2 * cube.y + 4 * cube.z) % 11;
}

RawVolume volume_of_labels(SampleType type, Index3 size, std::int64_t added = 0) {
  return integer_volume(type, size, [&](Index3 at) { return label_at(at) + added; });
}

std::vector<LabelCount> expected_counts(Index3 size) {
  std::map<std::uint64_t, LabelCount> counts;
  each_index(size, [&](Index3 at) {
    const auto place = [](Index3 p) {
      return std::array{static_cast<std::uint32_t>(p.x), static_cast<std::uint32_t>(p.y),
                        static_cast<std::uint32_t>(p.z)};
    };
    const LabelCount one{static_cast<std::uint64_t>(label_at(at)), 1, place(at),
                         place(at + splat(1))};
    const auto [entry, is_new] = counts.try_emplace(one.label, one);
    if (!is_new) add(entry->second, one);
  });
  std::vector<LabelCount> all;
  for (const auto& [label, count] : counts) all.push_back(count);
  return all;
}

const Settings each_label = {"labels.mode=each"};
const Settings small_pieces = {"work.brick=16", "work.shard=1", "work.chunk=16"};

LabelCounts counts_in(const fs::path& work) {
  const auto files = files_ending(work, "labels.all");
  EXPECT_EQ(files.size(), 1U);
  return LabelCounts(files.at(0));
}

std::vector<LabelCount> all_of(const LabelCounts& counts) {
  std::vector<LabelCount> all;
  counts.each([&](const LabelCount& count) {
    all.push_back(count);
    return true;
  });
  return all;
}

TEST(LabelIngest, CountsTheSameHoweverItIsCut) {
  const Index3 size{50, 33, 40};
  for (const SampleType type : {SampleType::u8, SampleType::i16, SampleType::u64}) {
    const Scene scene(volume_of_labels(type, size));
    std::optional<Hash128> first;
    for (const Settings& cut :
         {Settings{}, small_pieces, small_pieces + Settings{"work.copy=true", "work.chunk=8"},
          Settings{"work.brick=32", "work.shard=1", "work.copy=true", "run.threads=1"}}) {
      fs::remove_all(scene.work());
      VOXWELD_EXPECT_DONE(scene.command("ingest", each_label + cut + scene.in("scene")));
      const LabelCounts counts = counts_in(scene.work());
      EXPECT_EQ(all_of(counts), expected_counts(size));
      EXPECT_EQ(counts.summary().negatives, 0U);
      if (!first) first = counts.content_hash();
      EXPECT_EQ(counts.content_hash(), *first);
    }
  }
}

TEST(LabelIngest, InShares) {
  const Index3 size{50, 33, 40};
  const Scene scene(volume_of_labels(SampleType::u16, size));
  for (const Settings& cut : {small_pieces, small_pieces + Settings{"work.copy=true"}}) {
    fs::remove_all(scene.work());
    const auto part = [&](const std::vector<std::string>& options) {
      VOXWELD_EXPECT_DONE(
          scene.command_with("ingest", each_label + cut + scene.in("scene"), options));
    };
    for (const char* share : {"2/3", "0/3", "1/3"}) part({"--part", share});
    EXPECT_TRUE(files_ending(scene.work(), "labels.all").empty());
    const auto written = files_ending(scene.work(), ".labels");
    EXPECT_EQ(written.size(), 36U);
    std::vector<fs::file_time_type> times;
    for (const fs::path& file : written) times.push_back(fs::last_write_time(file));
    part({});
    EXPECT_EQ(all_of(counts_in(scene.work())), expected_counts(size));
    for (std::size_t i = 0; i < written.size(); ++i)
      EXPECT_EQ(fs::last_write_time(written[i]), times[i]) << written[i];
  }
}

TEST(LabelIngest, DoesWhatIsMissing) {
  const Scene scene(volume_of_labels(SampleType::u16, {50, 33, 40}));
  const Settings settings = each_label + small_pieces + scene.in("scene");
  const auto plan = [&] { return scene.command_with("run", settings, {"--dry-run"}).out; };
  EXPECT_TRUE(plan().starts_with(
      "ingest  would run: 36 of 36 shards whose labels are not counted (nothing was run here "
      "before)\n"))
      << plan();
  VOXWELD_EXPECT_DONE(scene.command("ingest", settings));
  EXPECT_TRUE(plan().starts_with("ingest  nothing to do: the input is read in place\n")) << plan();
  const auto shards = files_ending(scene.work(), ".labels");
  fs::remove(shards[7]);
  EXPECT_TRUE(plan().starts_with("ingest  nothing to do")) << "all together they are known";
  fs::remove(files_ending(scene.work(), "labels.all")[0]);
  EXPECT_TRUE(plan().starts_with("ingest  would run: 1 of 36 shards whose labels")) << plan();
  VOXWELD_EXPECT_DONE(scene.command("ingest", settings));
  fs::remove(files_ending(scene.work(), "labels.all")[0]);
  EXPECT_TRUE(plan().starts_with("ingest  would run: the labels are not counted\n")) << plan();
  VOXWELD_EXPECT_DONE(scene.command("ingest", settings));
  EXPECT_TRUE(files_ending(scene.work(), "").size() > 36) << "and they are kept";

  // A shard's counts that are damaged are never added up.
  fs::remove(files_ending(scene.work(), "labels.all")[0]);
  auto bytes = read_whole_file(shards[7]);
  bytes[70] ^= std::byte{1};
  write_whole_file(shards[7], bytes, Durability::rename_only);
  const ProgramResult damaged = scene.command("ingest", settings);
  expect_refused(damaged, shards[7].string(), 1);

  // Other samples are counted anew.
  scene.write_volume(volume_of_labels(SampleType::u16, {50, 33, 40}, 5));
  VOXWELD_EXPECT_DONE(scene.command("ingest", settings));
  EXPECT_EQ(all_of(counts_in(scene.work())).front().label, 5U);
}

TEST(LabelIngest, OfAStoreThatIsThere) {
  const Index3 size{50, 33, 40};
  const Scene scene(volume_of_labels(SampleType::u16, size));
  const Settings settings = small_pieces + Settings{"work.copy=true"} + scene.in("scene");
  VOXWELD_EXPECT_DONE(scene.command("ingest", settings));
  const auto stored = files_ending(scene.work(), ".shard");
  ASSERT_EQ(stored.size(), 36U);
  const auto time = fs::last_write_time(stored[0]);
  EXPECT_TRUE(files_ending(scene.work(), "labels.all").empty()) << "nobody asked";
  VOXWELD_EXPECT_DONE(scene.command("ingest", settings + each_label));
  EXPECT_EQ(fs::last_write_time(stored[0]), time);
  EXPECT_EQ(all_of(counts_in(scene.work())), expected_counts(size));
}

TEST(LabelIngest, BelowZeroIsNoLabel) {
  const Scene scene(volume_of_labels(SampleType::i16, {30, 30, 30}, -3));
  VOXWELD_EXPECT_DONE(scene.command("ingest", each_label + scene.in("scene")));
  const LabelCounts counts = counts_in(scene.work());
  std::uint64_t below = 0;
  for (const LabelCount& count : expected_counts({30, 30, 30}))
    below += count.label < 3 ? count.voxels : 0;
  EXPECT_EQ(counts.summary().negatives, below);
  EXPECT_EQ(counts.summary().negatives + counts.summary().samples, 27000U);
  scene.write_volume(volume_of_labels(SampleType::i16, {30, 30, 30}, -1000));
  VOXWELD_EXPECT_DONE(scene.command("ingest", each_label + scene.in("scene")));
  expect_refused(scene.command("build", each_label + scene.in("scene")),
                 "all of them are below zero");
}

TEST(LabelIngest, WhatCannotBeIsRefused) {
  const Scene scene(volume_of_labels(SampleType::u64, {30, 30, 30}));
  const auto refused = [&](const Settings& settings, const std::string& words) {
    VOXWELD_EXPECT_DONE(scene.command("ingest", each_label + scene.in("scene")));
    expect_refused(scene.command("build", each_label + scene.in("scene") + settings), words);
  };
  refused({"labels.select=[77, \"900-950\"]"},
          "labels.select, labels.background: none of the 20 labels of");
  refused({"labels.select=[77]"}, "is left, which run from 0 to 108");
  refused({"labels.min_voxels=20000"},
          "labels.min_voxels = 20000, labels.max_voxels = 0: none of the 19 materials of");
  const fs::path map = scene.directory() / "labels.csv";
  std::ofstream(map) << "label,material\n5,2\n5,3\n";
  refused({"labels.map=" + map.string()}, map.string() + ":3: label 5 is named in line 2 already");
  std::ofstream(map) << "label,material\n5,\n";
  refused({"labels.map=" + map.string(), "labels.select=mapped"},
          "labels.select, labels.background and labels.map: none of the 20");
  refused({"labels.map=" + map.string() + "x"}, "no such file of labels");
  RawVolume volume = volume_of_labels(SampleType::u64, {30, 30, 30});
  for (std::size_t i = 0; i < 16; ++i) volume.samples[8 * 30 * 30 * 12 + 32 + i] = std::byte{255};
  scene.write_volume(volume);
  refused({}, ": 2 samples are 18446744073709551615, the first in slice 12; that number");
  RawVolume real{{8, 8, 8}, SampleType::f32, std::vector<std::byte>(8 * 8 * 8 * 4), 0};
  expect_refused(Scene(real).command("ingest", each_label),
                 "labels.mode = \"each\": labels are integers as they are stored");
}

TEST(LabelIngest, WarnsOfWhatIsNotLookedAt) {
  const Scene scene(volume_of_labels(SampleType::u16, {30, 30, 30}));
  const ProgramResult off = scene.command("ingest", Settings{"labels.min_voxels=5"});
  VOXWELD_EXPECT_DONE(off);
  expect_says(off, "[labels] is not looked at");
  const fs::path map = scene.directory() / "labels.csv";
  std::ofstream(map) << "label,material\n0,7\n";
  const ProgramResult on =
      scene.command("ingest", each_label + Settings{"labels.map=" + map.string()});
  VOXWELD_EXPECT_DONE(on);
  expect_says(on, "labels.background leaves out 0 although");
}

// A build is keyed by what its labels stand for, and by nothing else that is said of them.
TEST(LabelKeys, AreOfTheRules) {
  const Scene scene(volume_of_labels(SampleType::u16, {30, 30, 30}));
  VOXWELD_EXPECT_DONE(scene.command("ingest", each_label + scene.in("scene")));
  const auto file = [&](const std::string& name, const std::string& text) {
    std::ofstream(scene.directory() / name) << text;
    return "labels.map=" + (scene.directory() / name).string();
  };
  const auto key = [&](const Settings& settings) {
    Config config = load_config(scene.config(), each_label + scene.in("scene") + settings);
    Jobs jobs(config);
    jobs.open_volume(config);
    EXPECT_EQ(jobs.build().parameters.labels.mode, config.labels.mode);
    EXPECT_NE(jobs.build().parameters.labels.rules, nullptr);
    return to_hex(jobs.build().key) + jobs.build().folder.string();
  };
  const std::string plain = key({});
  EXPECT_EQ(key({"labels.select=[\"1-18446744073709551614\"]"}), plain);
  EXPECT_EQ(key({"labels.min_voxels=0"}), plain);
  EXPECT_EQ(key({file("names.csv", "label,name,color\n3,three,#102030\n4,four,\n")}), plain);
  EXPECT_NE(key({"labels.mode=shared"}), plain);
  EXPECT_NE(key({"labels.background=[0, 1]"}), plain);
  EXPECT_NE(key({"labels.select=[1]"}), plain);
  const std::string merged = key({file("a.csv", "label,material,name\n3,5,x\n4,5,\n")});
  EXPECT_NE(merged, plain);
  EXPECT_EQ(key({file("b.json", "{\"4\": 5, \"3\": {\"material\": 5, \"name\": \"y\"}}")}), merged);
  EXPECT_EQ(key({file("a.csv", "label,material,color\n3-5,5,#000000\n")}), merged);
  EXPECT_NE(key({file("a.csv", "label,material\n3,6\n4,5\n")}), merged);
  // Sizes: by whom they leave out.
  const auto counts = expected_counts({30, 30, 30});
  std::uint64_t least = 27000, most = 0;
  for (const LabelCount& count : counts) {
    if (count.label == 0) continue;
    least = std::min(least, count.voxels);
    most = std::max(most, count.voxels);
  }
  const auto least_of = [&](std::uint64_t voxels) {
    return key({"labels.min_voxels=" + std::to_string(voxels)});
  };
  EXPECT_EQ(least_of(most), least_of(most - 1));
  EXPECT_EQ(least_of(1), least_of(least));
  EXPECT_NE(least_of(least), least_of(least + 1));
}

}  // namespace
}  // namespace voxweld::testing
