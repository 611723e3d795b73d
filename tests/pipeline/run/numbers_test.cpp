// Numbers that no mesh can be made of, or only one that nobody wants: refused, or warned of once.
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <limits>

#include "storage/manifest/task_report.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;

// Of f32, from a function of the sample's index; the isovalue is 0.
template <class F>
RawVolume real_volume(Index3 size, F&& value) {
  RawVolume volume{size, SampleType::f32, {}, 0};
  each_index(size, [&](Index3 at) {
    const auto sample = static_cast<float>(value(at));
    const auto* bytes = reinterpret_cast<const std::byte*>(&sample);
    volume.samples.insert(volume.samples.end(), bytes, bytes + sizeof sample);
  });
  return volume;
}

double ball(Index3 at, std::int64_t n) {
  const Index3 d = at - splat(n / 2);
  return static_cast<double>(n) / 3 -
         std::sqrt(static_cast<double>(d.x * d.x + d.y * d.y + d.z * d.z));
}

int count_of(const std::string& text, const std::string& words) {
  int count = 0;
  for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1))
    ++count;
  return count;
}

TEST(Numbers, ASpacingThatFloatsCannotHoldIsRefused) {
  const Scene scene(real_volume(splat(16), [](Index3 at) { return ball(at, 16); }));
  expect_refused(scene.run({"input.spacing=1e38"}), "coordinates reach 1.7e+39");
  expect_refused(scene.run({"input.spacing=1e-35"}), "smaller unit");
  VOXWELD_EXPECT_DONE(scene.run({"input.spacing=1e30"}));
  expect_good(scene.output());
}

TEST(Numbers, AMeshThatFloatsCannotHoldIsRefused) {
  const TempDirectory folder;
  std::string off = "OFF\n4 4 0\n0 0 0\n1e38 0 0\n0 1e38 0\n0 0 1e38\n";
  off += "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  write_whole_file(folder / "a.off", as_bytes(off), Durability::rename_only);
  const std::string config = "[input]\npath = \"a.off\"\nresolution = 16\n";
  write_whole_file(folder / "a.toml", as_bytes(config), Durability::rename_only);
  expect_refused(run_voxweld({"run", (folder / "a.toml").string()}), "larger unit");
}

TEST(Numbers, NansInsideAnObjectAreWarnedOfOnce) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  const Scene scene(real_volume({40, 40, 40}, [](Index3 at) {
    const bool missing = at.z == 20 && at.x >= 10 && at.x < 30 && at.y >= 15 && at.y < 33;
    return missing ? nan : ball(at, 40);
  }));
  // Bricks read their neighbours' samples too.
  for (const char* copy : {"copy=false", "copy=true"}) {
    const ProgramResult result = scene.run_in(
        copy + 5, {std::string("work.") + copy, "work.brick=16", "work.shard=1", "work.chunk=16"});
    VOXWELD_EXPECT_DONE(result);
    EXPECT_EQ(count_of(result.err, "NaN"), 1) << result.err;
    expect_says(result,
                "360 samples are NaN and count as outside. They lie in the samples 10 to 29 along "
                "x, 15 to 32 along y, 20 to 20 along z");
    expect_good(scene.output(copy + 5));
  }
  // Several threads at one shard.
  expect_says(scene.run_in("one_shard", {"work.brick=16", "work.shard=4", "run.threads=4"}),
              "360 samples are NaN");
  // A task of a cluster reports its own to whoever started it.
  NanCount nans;
  for (const char* part : {"0/2", "1/2"}) {
    const fs::path report = scene.directory() / "report.json";
    VOXWELD_EXPECT_DONE(scene.command_with("build", {"work.brick=16", "work.shard=1"},
                                           {"--part", part, "--report", report.string()}));
    nans.add(read_task_report(report)->nans);
  }
  EXPECT_EQ(nans.samples, 360U);
  EXPECT_EQ(nans.box, (Box3{{10, 15, 20}, {30, 33, 21}}));
  const ProgramResult cropped = scene.run_in("cropped", {"input.crop=[12, 0, 0, 40, 40, 40]"});
  expect_says(cropped, "324 samples are NaN");
  expect_says(cropped, "12 to 29 along x");
}

TEST(Numbers, AVolumeOfNansAloneIsCalledThat) {
  const Scene scene(
      real_volume(splat(16), [](Index3) { return std::numeric_limits<float>::quiet_NaN(); }));
  for (const char* copy : {"work.copy=false", "work.copy=true"}) {
    expect_refused(scene.run({copy}), "all samples are NaN");
    expect_refused(scene.run({copy, "surface.isovalue=otsu"}), "are NaN");
  }
}

TEST(Numbers, AMeshThatIsTheVolumesBoxIsWarnedOf) {
  const Scene scene(volume_of({20, 18, 17}, [](Index3 at) { return 10 + 3 * at.x; }));  // 10 to 67
  for (const char* copy : {"work.copy=false", "work.copy=true"}) {
    for (const Settings& surface : {Settings{"surface.isovalue=10"}, Settings{"surface.isovalue=3"},
                                    Settings{"surface.isovalue=67", "surface.inside=below"}}) {
      const ProgramResult result = scene.run(surface + Settings{copy});
      VOXWELD_EXPECT_DONE(result);
      EXPECT_EQ(count_of(result.err, "the mesh is the box of the volume"), 1) << result.err;
      expect_says(result, "the values run from 10 to 67");
    }
    const ProgramResult sound = scene.run({"surface.isovalue=11", copy});
    VOXWELD_EXPECT_DONE(sound);
    EXPECT_EQ(count_of(sound.err, "warning"), 0) << sound.err;
  }
  // As many crossing edges, but a corner is outside.
  const Scene corner(volume_of(splat(12), [](Index3 at) { return at == Index3{} ? 0 : 200; }));
  const ProgramResult result = corner.run();
  VOXWELD_EXPECT_DONE(result);
  EXPECT_EQ(count_of(result.err, "warning"), 0) << result.err;
}

TEST(Numbers, WhatIsNoRegularFileIsRefusedAtOnce) {
  const TempDirectory folder;
  const std::string fifo = (folder / "a.nrrd").string(), loop = (folder / "b.nrrd").string();
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  fs::create_symlink(loop, loop);
  fs::create_symlink("/dev/zero", folder / "c.nrrd");
  for (const std::string& input :
       {fifo, loop, (folder / "c.nrrd").string(), std::string("/dev/zero")}) {
    const std::string config =
        fmt::format("[input]\npath = \"{}\"\n[surface]\nisovalue = 1\n", input);
    write_whole_file(folder / "a.toml", as_bytes(config), Durability::rename_only);
    const std::string words = input == loop ? "symbolic link" : "not a regular file";
    for (const Arguments& command :
         {Arguments{"run", (folder / "a.toml").string()}, Arguments{"info", input},
          Arguments{"init", input, "-o", (folder / "new.toml").string()}}) {
      const ProgramResult result = run_voxweld(command);
      EXPECT_EQ(result.exit_code, 2) << result.err;
      expect_says(result, words);
      expect_says(result, input);
      EXPECT_LT(result.seconds, 10);
      EXPECT_EQ(count_of(result.err, "error: "), 1) << result.err;
    }
  }
}

TEST(Numbers, AnUnreadableFileIsNamedAndNotItsFolder) {
  const TempDirectory folder;
  write_whole_file(folder / "a.nrrd", as_bytes(std::string("NRRD0004\n")), Durability::rename_only);
  fs::permissions(folder / "a.nrrd", fs::perms::none);
  fs::permissions(folder.path(), fs::perms::all);
  const bool root = geteuid() == 0;  // who may read all
  if (root && seteuid(65534) != 0) GTEST_SKIP() << "needs the right to be another user";
  std::string said;
  try {
    ReadFile(folder / "a.nrrd");
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), 2);
    said = error.what();
  }
  if (root) {
    ASSERT_EQ(seteuid(0), 0);
  }
  EXPECT_NE(said.find((folder / "a.nrrd").string() + ": cannot be read: Permission denied"),
            std::string::npos)
      << said;
}

// The lists of billions of shards would take more than there is.
TEST(Numbers, MoreShardsThanMemoryCanListAreRefused) {
  const TempDirectory folder;
  const std::string config =
      "[input]\nformat = \"empty\"\nsize = [524287, 524287, 524287]\n[[edit]]\nop = \"add\"\n"
      "shape = \"sphere\"\ncenter = [9, 9, 9]\nradius = 5\n";
  write_whole_file(folder / "a.toml", as_bytes(config), Durability::rename_only);
  const std::string path = (folder / "a.toml").string();
  expect_refused(run_voxweld({"run", path}), "8589934592 shards");
  const ProgramResult plan = run_voxweld({"plan", path, "--json"});
  VOXWELD_EXPECT_DONE(plan);
  EXPECT_LT(plan.seconds, 20);
  EXPECT_EQ(nlohmann::json::parse(plan.out).at("stages").at(0).at("units"), 8589934592U);
}

}  // namespace
}  // namespace voxweld::testing
