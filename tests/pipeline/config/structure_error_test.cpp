// What is wrong beyond a single value: syntax, unknown names, missing keys, values that do not go
// together.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/pipeline/config/config_texts.h"

namespace voxweld {
namespace {

using ::testing::EndsWith;
using testing::error_of;
using testing::least_config;
using ::testing::StartsWith;

TEST(StructureError, Syntax) {
  const std::string advice = "; strings are written in \"quotes\", lists in [brackets]";
  for (const char* text : {"[input]\npath = scan.nrrd\n", "[input]\npath = \"scan.nrrd\n",
                           "[input]\npath =\n", "[input]\npath = \"a\xff\"\n"}) {
    const std::string message = error_of(text);
    EXPECT_THAT(message, StartsWith("/data/scan.toml:2:")) << text;
    EXPECT_THAT(message, ::testing::HasSubstr(": not valid TOML: ")) << text;
    EXPECT_THAT(message, EndsWith(advice)) << text;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
  EXPECT_THAT(error_of("[work]\nchunk = 32\nchunk = 64\n"),
              StartsWith("/data/scan.toml:3:9: not valid TOML: "));
}

TEST(StructureError, UnknownTable) {
  EXPECT_EQ(error_of(least_config("[surfce]\nisovalue = 3\n")),
            "/data/scan.toml:3:2: unknown table [surfce]; did you mean [surface]? The tables are "
            "input, work, surface, labels, simplify, output, run, slurm and any number of "
            "[[filter]] and [[edit]]");
  EXPECT_EQ(error_of(least_config("[camera]\n")),
            "/data/scan.toml:3:2: unknown table [camera]. The tables are input, work, surface, "
            "labels, simplify, output, run, slurm and any number of "
            "[[filter]] and [[edit]]");
}

TEST(StructureError, UnknownKey) {
  EXPECT_EQ(error_of("[surface]\nisvalue = 3\n"),
            "/data/scan.toml:2:1: unknown key surface.isvalue; did you mean surface.isovalue? "
            "[surface] takes isovalue, label, inside, border, gradient");
  EXPECT_EQ(error_of("[run]\n\n  bogus = 3\n"),
            "/data/scan.toml:3:3: unknown key run.bogus. [run] takes executor, threads, memory");
  EXPECT_EQ(error_of("[run]\nchunk = 32\n"),
            "/data/scan.toml:2:1: unknown key run.chunk; did you mean work.chunk? [run] takes "
            "executor, threads, memory");
  EXPECT_EQ(error_of("[run.local]\nthreads = 3\n"),
            "/data/scan.toml:1:6: unknown key run.local. [run] takes executor, threads, memory");
}

TEST(StructureError, TheFirstErrorInTheFileIsTold) {
  EXPECT_THAT(error_of("[work]\nzzzz = 1\n[input]\naaaa = 1\n"),
              StartsWith("/data/scan.toml:2:1: unknown key work.zzzz"));
}

TEST(StructureError, OutsideTables) {
  EXPECT_EQ(error_of("chunk = 32\n"),
            "/data/scan.toml:1:1: key chunk stands outside any table; did you mean work.chunk? The "
            "tables are input, work, surface, labels, simplify, output, run, slurm and any number "
            "of [[filter]] and [[edit]]");
  EXPECT_EQ(error_of("bogus = 32\n"),
            "/data/scan.toml:1:1: key bogus stands outside any table. The tables are input, work, "
            "surface, labels, simplify, output, run, slurm and any number of "
            "[[filter]] and [[edit]]");
  EXPECT_EQ(error_of("run = 3\n"),
            "/data/scan.toml:1:1: expected a table [run] with keys executor, threads, memory, "
            "found 3");
  EXPECT_EQ(error_of("[[run]]\nthreads = 3\n"),
            "/data/scan.toml:1:1: expected a table [run] with keys executor, threads, memory, "
            "found [[run]]");
}

TEST(StructureError, HostileNamesAreEscapedAndCut) {
  const std::string message =
      error_of("[run]\n\"a\\u001b[2J" + std::string(5000, 'b') + "\" = 1\n");
  EXPECT_LT(message.size(), 200U);
  EXPECT_EQ(message.find('\x1b'), std::string::npos);
}

TEST(StructureError, MissingKeys) {
  EXPECT_EQ(
      error_of("[surface]\nisovalue = 3\n"),
      "/data/scan.toml: missing key input.path (expected a path in quotes): The volume: a "
      "file, a directory of slices or a Zarr array; or a closed triangle mesh in an .stl, .off, "
      ".obj or .ply file. What it holds decides what is done again, not its name.");
  EXPECT_EQ(
      error_of("[input]\npath = \"a\"\n"),
      "/data/scan.toml: missing key surface.isovalue (expected a finite number, "
      "\"otsu\" or \"valley\", or a list of such): The value the surface runs through. \"otsu\" "
      "and \"valley\" choose "
      "it from the histogram: \"otsu\" so that it parts the samples into two classes best, "
      "\"valley\" in the deepest valley between the two clearest peaks, also where one of them is "
      "small (`voxweld histogram` shows both). A list makes a set of meshes for each of its "
      "values, in folders of output.directory. Where the file has a slope and an intercept it is "
      "a real value, such as HU, not a stored number. Integers above 9223372036854775807 are "
      "written in quotes.");
  EXPECT_THAT(error_of(""), StartsWith("/data/scan.toml: missing key input.path"));
}

TEST(StructureError, EmptyCrop) {
  EXPECT_EQ(error_of(least_config("input.crop = [0, 0, 8, 4, 4, 8]\n")),
            "/data/scan.toml:3:14: input.crop = [0, 0, 8, 4, 4, 8]: expected [x0, y0, z0, x1, y1, "
            "z1] with x0 < x1, y0 < y1 and z0 < z1");
}

TEST(StructureError, RawNeedsItsLayout) {
  EXPECT_EQ(error_of(least_config("input.format = \"raw\"\n")),
            "/data/scan.toml:3:16: input.size: missing, and raw files need it: expected a list of "
            "3 integers from 1 to 524287");
  EXPECT_EQ(error_of(least_config("input.size = [8, 8, 8]\n")),
            "/data/scan.toml:3:14: input.type: missing, and raw files need it: expected \"uint8\", "
            "\"int8\", \"uint16\", \"int16\", \"uint32\", \"int32\", \"uint64\", \"int64\", "
            "\"float32\" or \"float64\"");
  EXPECT_EQ(error_of(least_config("input.format = \"nrrd\"\ninput.endian = \"big\"\n")),
            "/data/scan.toml:4:16: input.endian = \"big\": only raw files take it; remove it, or "
            "set input.format = \"raw\"");
}

TEST(StructureError, ChunksDivideShards) {
  EXPECT_EQ(error_of(least_config("work.chunk = 64\nwork.brick = 16\nwork.shard = 2\n")),
            "/data/scan.toml:3:14: work.chunk = 64: expected at most work.brick * work.shard = 16 "
            "* 2 = 32, so that chunks divide shards; lower work.chunk or raise work.brick or "
            "work.shard");
  testing::parse(least_config("work.chunk = 32\nwork.brick = 16\nwork.shard = 2\n"));
}

TEST(Config, AChunkThatIsNotGivenFitsSmallShards) {
  EXPECT_EQ(testing::parse(least_config("work.brick = 16\nwork.shard = 1\n")).work.chunk, 16);
  EXPECT_EQ(testing::parse(least_config("work.brick = 16\nwork.shard = 4\n")).work.chunk, 32);
}

TEST(StructureError, SomethingMustBeWritten) {
  EXPECT_EQ(error_of(least_config("output.merged = false\noutput.tiles = false\n")),
            "/data/scan.toml:4:16: output.tiles = false: with output.merged = false there is "
            "nothing to write; set one of the two to true");
  testing::parse(least_config("output.tiles = false\n"));
  testing::parse(least_config("output.merged = false\n"));
}

TEST(StructureError, TasksHaveTheMemoryTheyMayUse) {
  const std::string slurm = "run.executor = \"slurm\"\n";
  EXPECT_EQ(
      error_of(least_config(slurm + "slurm.mem = \"2GiB\"\n")),
      "/data/scan.toml:4:13: slurm.mem = \"2GiB\": expected at least run.memory = 4GiB, which "
      "a task's process may use; raise it, or leave it \"auto\"");
  testing::parse(least_config(slurm + "slurm.mem = \"4GiB\"\n"));
  testing::parse(least_config("slurm.mem = \"2GiB\"\n"));
}

}  // namespace
}  // namespace voxweld
