// What a build finds of its bricks' samples spares the next one, with another isovalue, to read those
// without a surface.
#include <cmath>
#include <limits>

#include "storage/artifact/brick_ranges_artifact.h"
#include "storage/support/error.h"
#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

const Settings many_bricks = {"work.brick=16", "work.shard=2"};

// A ball in the middle: most bricks hold none of it.
RawVolume round_volume(std::int64_t side, double scale = 1) {
  return volume_of(splat(side), [&](Index3 at) {
    double squared = 0;
    for (int a = 0; a < 3; ++a) {
      const double d = static_cast<double>(at[a]) - static_cast<double>(side) / 2;
      squared += d * d;
    }
    return std::clamp(static_cast<int>(200 - scale * 6 * std::sqrt(squared)), 0, 255);
  });
}

std::vector<std::filesystem::path> range_files(const Scene& scene) {
  return files_ending(scene.work(), ".16");
}

bool was_spared(const ProgramResult& result) {
  return result.err.find("as an earlier build found: not read") != std::string::npos;
}

TEST(BrickRanges, ASecondIsovalueLeavesTheSameAsARunByItself) {
  const Scene scene(round_volume(100));
  const Settings other = many_bricks + Settings{"surface.isovalue=70"};
  const Tree expected = scene.clean_tree(other);
  scene.forget();
  const ProgramResult first = scene.run(many_bricks);
  VOXWELD_EXPECT_DONE(first);
  EXPECT_FALSE(was_spared(first));
  const std::size_t files = range_files(scene).size();
  EXPECT_GT(files, 8U);
  const ProgramResult second = scene.run(other);
  VOXWELD_EXPECT_DONE(second);
  EXPECT_TRUE(was_spared(second));
  EXPECT_EQ(difference(expected, output_tree(scene.output())), "");
  // The other side, on which nearly all is inside.
  const ProgramResult third = scene.run(many_bricks + Settings{"surface.inside=below"});
  VOXWELD_EXPECT_DONE(third);
  EXPECT_TRUE(was_spared(third));
  EXPECT_EQ(difference(scene.clean_tree(many_bricks + Settings{"surface.inside=below"}),
                       output_tree(scene.output())),
            "");
}

// A larger tolerance on top: nothing is built, whether the first build has read all bricks or not.
TEST(BrickRanges, ALargerToleranceStillReadsNoSample) {
  const Scene scene(round_volume(100));
  const Settings other = many_bricks + Settings{"surface.isovalue=70"};
  VOXWELD_EXPECT_DONE(scene.run(many_bricks));
  VOXWELD_EXPECT_DONE(scene.run(other));
  for (const Settings& settings : {many_bricks, other}) {
    const Settings coarser = settings + Settings{"simplify.tolerance=0.3"};
    const ProgramResult result = scene.run(coarser);
    VOXWELD_EXPECT_DONE(result);
    expect_says(result, "bricks 0 were built");
    const Tree found = output_tree(scene.output());
    EXPECT_EQ(difference(scene.clean_tree(coarser), found), "");
    VOXWELD_EXPECT_DONE(scene.run(many_bricks));
    VOXWELD_EXPECT_DONE(scene.run(other));
  }
}

// Of another volume nothing is believed.
TEST(BrickRanges, AreOfTheSamplesTheyWereFoundIn) {
  const Scene scene(round_volume(70));
  VOXWELD_EXPECT_DONE(scene.run(many_bricks));
  scene.write_volume(round_volume(70, 0.6));
  const Settings other = many_bricks + Settings{"surface.isovalue=70"};
  const ProgramResult second = scene.run(other);
  VOXWELD_EXPECT_DONE(second);
  EXPECT_FALSE(was_spared(second));
  const Tree found = output_tree(scene.output());
  EXPECT_EQ(difference(scene.clean_tree(other), found), "");
}

// A file that was merely touched: what was built with ranges is kept as is what was built without.
TEST(BrickRanges, ATouchedVolumeRebuildsNothing) {
  const Scene scene(round_volume(70));
  const Settings other = many_bricks + Settings{"surface.isovalue=70"};
  VOXWELD_EXPECT_DONE(scene.run(many_bricks));
  VOXWELD_EXPECT_DONE(scene.run(other));
  std::filesystem::last_write_time(scene.volume(), std::filesystem::file_time_type::clock::now());
  for (const Settings& settings : {other, many_bricks, other}) {
    VOXWELD_EXPECT_DONE(scene.run(settings));
    EXPECT_EQ(units_run(scene.output()).at("build"), 0U);
  }
}

TEST(BrickRanges, DamagedOnesAreMadeAnew) {
  const Scene scene(round_volume(70));
  const Settings other = many_bricks + Settings{"surface.isovalue=70"};
  const Tree expected = scene.clean_tree(other);
  scene.forget();
  VOXWELD_EXPECT_DONE(scene.run(many_bricks));
  const auto files = range_files(scene);
  for (const auto& file : files)
    std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  const ProgramResult second = scene.run(other);
  VOXWELD_EXPECT_DONE(second);
  EXPECT_FALSE(was_spared(second));
  EXPECT_EQ(difference(expected, output_tree(scene.output())), "");
  EXPECT_TRUE(was_spared(scene.run(many_bricks + Settings{"surface.isovalue=90"})));
}

// Whoever has other bricks has other ranges, and those that were there stay.
TEST(BrickRanges, OfOtherBricksAreOthers) {
  const Scene scene(round_volume(100));
  VOXWELD_EXPECT_DONE(scene.run(many_bricks));
  EXPECT_FALSE(was_spared(scene.run({"work.brick=32", "surface.isovalue=70"})));
  EXPECT_TRUE(was_spared(scene.run(many_bricks + Settings{"surface.isovalue=90"})));
}

// Those with NaNs are read again: the user hears of the same ones.
TEST(BrickRanges, DoNotHideNans) {
  RawVolume volume = round_volume(70);
  RawVolume real{volume.size, SampleType::f32, {}, 128};
  for (std::size_t i = 0; i < volume.samples.size(); ++i) {
    float value = static_cast<float>(std::to_integer<int>(volume.samples[i]));
    if (i % 343 == 5 && i < 30000) value = std::numeric_limits<float>::quiet_NaN();
    const auto* bytes = reinterpret_cast<const std::byte*>(&value);
    real.samples.insert(real.samples.end(), bytes, bytes + sizeof value);
  }
  const Scene scene(real);
  const auto nans_of = [](const ProgramResult& result) {
    VOXWELD_EXPECT_DONE(result);
    const std::size_t at = result.err.find("samples are NaN");
    EXPECT_NE(at, std::string::npos) << result.err;
    return result.err.substr(at - 4, 200);
  };
  const std::string first = nans_of(scene.run(many_bricks));
  const ProgramResult second = scene.run(many_bricks + Settings{"surface.isovalue=70"});
  EXPECT_TRUE(was_spared(second));
  EXPECT_EQ(nans_of(second), first);
}

TEST(BrickRanges, AreReadAsTheyWereWritten) {
  const TempDirectory folder;
  const auto path = folder / "a.16";
  const Hash128 key{1, 2}, stamp{3, 4};
  const std::vector<BrickRange> ranges = {BrickRange::make(3, {-1.5, 2, false, false}),
                                          BrickRange::make(7, {0, 0, true, true}),
                                          BrickRange::make(9, {5, 5, true, false})};
  write_brick_ranges(path, {key, stamp, ranges});
  const BrickRangesArtifact found = read_brick_ranges(path);
  EXPECT_EQ(found.key, key);
  EXPECT_EQ(found.stamp, stamp);
  ASSERT_EQ(found.ranges.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(found.ranges[i].brick, ranges[i].brick);
    EXPECT_EQ(found.ranges[i].lo, ranges[i].lo);
    EXPECT_EQ(found.ranges[i].hi, ranges[i].hi);
    EXPECT_EQ(found.ranges[i].range().any_nan, i > 0);
    EXPECT_EQ(found.ranges[i].range().empty, i == 1);
  }
  write_brick_ranges(path, {key, stamp, {ranges[1], ranges[0]}});
  EXPECT_THROW(read_brick_ranges(path), DamagedArtifact);  // in no order
  write_brick_ranges(path, {key, stamp, {BrickRange{1, 5, 4, 0}}});
  EXPECT_THROW(read_brick_ranges(path), DamagedArtifact);
}

}  // namespace
}  // namespace voxweld::testing
