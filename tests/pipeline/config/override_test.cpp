#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/pipeline/config/config_texts.h"

namespace voxweld {
namespace {

using testing::error_of;
using testing::least_config;
using testing::parse;

TEST(Override, TakesTomlAndBareWords) {
  const Config config =
      parse(least_config(), {"work.chunk=64", " work.copy = true", "surface.inside=below",
                             "surface.border=\"open\"", "input.crop=[0,0,0,9,8,7]",
                             "run.memory=2GiB", "output.formats=[\"glb\"]", "run.threads=3 # x"});
  EXPECT_EQ(config.work.chunk, 64);
  EXPECT_EQ(config.work.copy, WorkConfig::Copy::always);
  EXPECT_EQ(config.surface.inside, SurfaceConfig::Inside::below);
  EXPECT_EQ(config.surface.border, SurfaceConfig::Border::open);
  EXPECT_EQ(config.input.crop, (Box3{{0, 0, 0}, {9, 8, 7}}));
  EXPECT_EQ(config.run.memory, std::uint64_t{2} << 30);
  EXPECT_EQ(config.output.formats, std::vector<std::string>{"glb"});
  EXPECT_EQ(config.run.threads, 3);
}

TEST(Override, TheLastOneWins) {
  const Config config = parse(least_config("work.chunk = 8\n"), {"work.chunk=16", "work.chunk=64"});
  EXPECT_EQ(config.work.chunk, 64);
}

TEST(Override, MaySupplyWhatTheFileLacks) {
  EXPECT_EQ(parse("", {"input.path=a.nrrd", "surface.isovalue=otsu"}).surface.isovalue,
            std::nullopt);
}

TEST(Override, PathsAreRelativeToTheCurrentDirectory) {
  const auto here = std::filesystem::current_path();
  const Config config = parse(
      least_config(), {"input.path=a=b#c.nrrd", "work.directory=42", "output.directory=/out/x"});
  EXPECT_EQ(config.input.path, here / "a=b#c.nrrd");
  EXPECT_EQ(config.work.directory, here / "42");
  EXPECT_EQ(config.output.directory, "/out/x");
}

TEST(Override, NamesAndTimesNeedNoQuotes) {
  const Config config = parse(
      least_config(), {"slurm.partition=42", "slurm.account=true", "slurm.time=04:00:00",
                       "slurm.qos=2024-05-27", "slurm.mem=auto", "slurm.shards_per_task=auto"});
  EXPECT_EQ(config.slurm.partition, "42");
  EXPECT_EQ(config.slurm.account, "true");
  EXPECT_EQ(config.slurm.time, "04:00:00");
  EXPECT_EQ(config.slurm.qos, "2024-05-27");
  EXPECT_EQ(config.slurm.mem, 0U);
}

TEST(Override, RefusesWhatIsNoAssignment) {
  const std::string advice = ": expected table.key=value, for example --set simplify.tolerance=0.2";
  EXPECT_EQ(error_of(least_config(), {"work.chunk"}), "--set work.chunk" + advice);
  EXPECT_EQ(error_of(least_config(), {"chunk=3"}), "--set chunk=3" + advice);
  EXPECT_EQ(error_of(least_config(), {""}), "--set " + advice);
  EXPECT_EQ(error_of(least_config(), {"wrok.chunk=3"}),
            "--set wrok.chunk=3: unknown table [wrok]; did you mean [work]? The tables are input, "
            "work, surface, labels, simplify, output, run, slurm");
  EXPECT_EQ(error_of(least_config(), {"run.thread=3"}),
            "--set run.thread=3: unknown key run.thread; did you mean run.threads? [run] takes "
            "executor, threads, memory");
}

TEST(Override, RefusesBrokenToml) {
  EXPECT_EQ(
      error_of(least_config(), {"output.formats=[glb"}),
      "--set output.formats=[glb: output.formats: expected a list of one or more of \"drc\", "
      "\"glb\", \"glb-plain\", \"meshopt\", \"ply\", \"stl\", \"obj\" or \"vtp\", each once, found "
      "[glb, which is "
      "not valid TOML");
  EXPECT_EQ(error_of(least_config(), {"work.chunk="}),
            "--set work.chunk=: work.chunk: expected a power of two from 8 to 256 (default: 32), "
            "found \"\" (a string)");
  EXPECT_THAT(error_of(least_config(), {"work.chunk=32\nbrick=64"}),
              ::testing::HasSubstr("found \"32\\u000abrick=64\" (a string)"));
}

TEST(Override, CrossChecksNameThem) {
  EXPECT_EQ(error_of(least_config("output.tiles = false\n"), {"output.merged=false"}),
            "/data/scan.toml:3:16: output.tiles = false: with output.merged = false there is "
            "nothing to write; set one of the two to true");
  EXPECT_THAT(error_of(least_config(), {"input.crop=[0,0,0,0,1,1]"}),
              ::testing::StartsWith("--set input.crop=[0,0,0,0,1,1]: input.crop = "));
}

}  // namespace
}  // namespace voxweld
