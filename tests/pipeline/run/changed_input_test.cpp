// The input changes while it is read, or between two runs without its size and time telling: never
// a mesh of the old and the new.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <fstream>

#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr Index3 side_48{48, 48, 48};

RawVolume ball_of(double radius) {
  return volume_of(side_48, [=](Index3 at) {
    double square = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double d = static_cast<double>(at[axis]) - 23.5;
      square += d * d;
    }
    return static_cast<int>(std::clamp(128 + 16 * (radius - std::sqrt(square)), 0.0, 255.0));
  });
}

const Settings small_bricks = {"work.brick=16", "work.shard=1", "work.chunk=16", "run.threads=1"};

// In place, as mmap and many editors of volumes do; then its time is set back.
void change_behind_its_time(const Scene& scene, const RawVolume& to) {
  struct stat before {};
  ASSERT_EQ(stat(scene.volume().c_str(), &before), 0);
  {
    std::fstream file(scene.volume(), std::ios::in | std::ios::out | std::ios::binary);
    file.write(reinterpret_cast<const char*>(to.samples.data()),
               static_cast<std::streamsize>(to.samples.size()));
  }
  const timespec times[] = {before.st_atim, before.st_mtim};
  ASSERT_EQ(utimensat(AT_FDCWD, scene.volume().c_str(), times, 0), 0);
}

class ChangedInput : public ::testing::TestWithParam<const char*> {
 protected:
  Settings settings() const { return small_bricks + Settings{GetParam()}; }
};

TEST_P(ChangedInput, WithTheSameSizeAndTimeIsSeenByTheNextRun) {
  const Scene scene(ball_of(18));
  VOXWELD_EXPECT_DONE(scene.run(settings()));
  change_behind_its_time(scene, ball_of(12));
  VOXWELD_EXPECT_DONE(scene.run(settings()));
  EXPECT_EQ(difference(scene.clean_tree(settings()), output_tree(scene.output())), "");
}

// A new time alone is no change: the samples are read again, and nothing is built.
TEST_P(ChangedInput, IsToldFromOneThatWasOnlyTouched) {
  const Scene scene(ball_of(18));
  VOXWELD_EXPECT_DONE(scene.run(settings()));
  fs::last_write_time(scene.volume(), fs::file_time_type::clock::now());
  VOXWELD_EXPECT_DONE(scene.run(settings()));
  EXPECT_EQ(units_run(scene.output())["build"], 0U);
}

// Shell commands that change `$1` while a run reads it; `$2` is another volume of its size.
const std::vector<std::pair<const char*, const char*>> changes = {
    {"written over", "dd if=\"$2\" of=\"$1\" conv=notrunc status=none"},
    {"written over, and its time set back",
     "touch -r \"$1\" \"$1.t\"; dd if=\"$2\" of=\"$1\" conv=notrunc status=none; "
     "touch -r \"$1.t\" \"$1\""},
    {"replaced", "cp \"$2\" \"$1.new\"; mv \"$1.new\" \"$1\""},
    {"cut short", "truncate -s 50000 \"$1\""},
    {"longer", "cat \"$2\" >> \"$1\""},
    {"removed", "rm \"$1\""},
};

// The 3rd shard of the store, the 10th of the build ...
const std::vector<std::pair<const char*, const char*>> moments = {
    {"3", "after rename /scene.work/ingest-"}, {"10", ".octree"}, {"1", ".tile"}};

TEST_P(ChangedInput, WhileARunReadsItIsNoMesh) {
  int changed = 0;
  const Scene scene(ball_of(18));
  const fs::path other = scene.directory() / "other.raw", kept = scene.directory() / "kept.raw";
  fs::copy_file(scene.volume(), kept);
  {
    std::ofstream out(other, std::ios::binary);
    const RawVolume volume = ball_of(12);
    out.write(reinterpret_cast<const char*>(volume.samples.data()),
              static_cast<std::streamsize>(volume.samples.size()));
  }
  for (const auto& [name, command] : changes) {
    for (const auto& [nth, with] : moments) {
      SCOPED_TRACE(fmt::format("{}, at {} {}", name, nth, with));
      fs::remove_all(scene.work());
      fs::remove_all(scene.output());
      fs::copy_file(kept, scene.volume(), fs::copy_options::overwrite_existing);
      const fs::path done = scene.directory() / "done";
      fs::remove(done);
      const Environment changing =
          watched(scene, {{"VOXWELD_POINTS_NTH", nth},
                          {"VOXWELD_POINTS_WITH", with},
                          {"VOXWELD_POINTS_DO",
                           fmt::format("set -- '{}' '{}'; {}; touch '{}'", scene.volume().string(),
                                       other.string(), command, done.string())}});
      const ProgramResult result = scene.run(settings());
      if (!fs::exists(done)) continue;  // without a store
      ++changed;
      EXPECT_EQ(result.exit_code, 2) << result.err;
      EXPECT_THAT(result.err, HasSubstr(scene.volume().string()));
      EXPECT_THAT(result.err, HasSubstr("changed while it was read"));
      EXPECT_THAT(result.err, Not(HasSubstr("bug")));
      EXPECT_FALSE(fs::exists(scene.output() / "manifest.json"));
    }
  }
  EXPECT_GE(changed, 12);
}

INSTANTIATE_TEST_SUITE_P(, ChangedInput, ::testing::Values("work.copy=false", "work.copy=true"),
                         [](const auto& named) {
                           return std::string(named.index == 0 ? "InPlace" : "Copied");
                         });

// A share of a stage does not look at the whole of the one before; the rule's isovalue it needs.
TEST(ChangedBetweenStages, AShareOfBuildWantsItsHistogramAnew) {
  const Scene scene(ball_of(18));
  const Settings settings{"surface.isovalue=otsu", "work.copy=true"};
  VOXWELD_EXPECT_DONE(scene.command("ingest", settings));
  const Arguments share{"--part", "0/2"};
  VOXWELD_EXPECT_DONE(scene.command_with("build", settings, share));
  fs::last_write_time(scene.volume(), fs::file_time_type::clock::now() + std::chrono::hours(1));
  expect_refused(scene.command_with("build", settings, share),
                 "needs the histogram that stage ingest makes of");
  VOXWELD_EXPECT_DONE(scene.command("ingest", settings));
  VOXWELD_EXPECT_DONE(scene.command_with("build", settings, share));
}

std::string verified(const Scene& scene, const Settings& options = {}) {
  const ProgramResult result = run_voxweld(Settings{"verify", scene.output()} + options);
  EXPECT_EQ(result.exit_code, result.out.find("good:") == std::string::npos ? 1 : 0);
  return result.out;
}

TEST(Verify, SaysWhereTheInputOrTheConfigHasChangedSince) {
  const Scene scene(ball_of(18));
  VOXWELD_EXPECT_DONE(scene.run());
  EXPECT_THAT(verified(scene), HasSubstr("good:"));
  // Where and how fast it is run makes no other mesh.
  std::ofstream(scene.config(), std::ios::app) << "memory = \"1GiB\"\n";
  EXPECT_THAT(verified(scene), HasSubstr("good:"));
  std::ofstream(scene.config(), std::ios::app) << "\n[output]\nprecision = 0.02\n";
  EXPECT_THAT(verified(scene), AllOf(HasSubstr(scene.config().string() + ": asks for another"),
                                     HasSubstr("bad: 1 ")));
  EXPECT_THAT(verified(scene, {"--no-origin"}), HasSubstr("good:"));
  fs::remove(scene.config());
  EXPECT_THAT(verified(scene), HasSubstr("good:"));

  fs::last_write_time(scene.volume(), fs::file_time_type::clock::now() + std::chrono::hours(1));
  EXPECT_THAT(verified(scene), HasSubstr(scene.volume().string() + ": has changed since"));
  fs::remove(scene.volume());
  EXPECT_THAT(verified(scene), HasSubstr("good:"));
}

}  // namespace
}  // namespace voxweld::testing
