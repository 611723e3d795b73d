#include "pipeline/config/config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/config/rule.h"
#include "storage/support/file_io.h"
#include "tests/pipeline/config/config_texts.h"
#include "tests/support/error_text.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using ::testing::HasSubstr;
using testing::least_config;
using testing::parse;

void write(const std::filesystem::path& path, const std::string& text) {
  write_whole_file(path, as_bytes(text), Durability::rename_only);
}

TEST(Config, FillsInDefaults) {
  const Config config = parse(least_config());
  Config expected;
  expected.input.path = "/data/scan.nrrd";
  expected.work.directory = "/data/scan.work";
  expected.output.directory = "/data/scan.mesh";
  expected.surface.isovalue = 5;
  EXPECT_EQ(config, expected);
}

TEST(Config, TakesEveryKey) {
  const Config config = parse(R"(
[input]
path = "volumes/a.raw"
format = "raw"
crop = [1, 2, 3, 10, 20, 30]
spacing = [0.5, 1, 2.5]
unit = "mm"
size = [64, 65, 66]
type = "int16"
endian = "big"
header_bytes = 512
[work]
directory = "/scratch/a"
chunk = 64
brick = 128
shard = 1
copy = false
[surface]
isovalue = "otsu"
inside = "below"
border = "open"
gradient = "central"
[simplify]
enabled = false
tolerance = 2
tolerance_unit = "physical"
metric = "sum"
topology = "free"
qef = "normal"
[output]
directory = "../out"
formats = ["glb"]
merged = true
tiles = false
tile_vertices = 2048
precision = 0.5
normals = false
report = false
[run]
executor = "slurm"
threads = 3
memory = "512MiB"
[slurm]
partition = "long,short"
account = "imaging"
qos = "normal"
time = "1-12:30"
cpus_per_task = 16
mem = "2GiB"
max_array = 200
max_running = 50
shards_per_task = 8
retries = 0
extra = ["--constraint=avx2", "-x node7", "--exclusive"]
prologue = ["module load gcc/12", "", "export A='b c'"]
)");
  Config expected;
  expected.input = {.path = "/data/volumes/a.raw",
                    .format = "raw",
                    .crop = Box3{{1, 2, 3}, {10, 20, 30}},
                    .spacing = Vec3{0.5, 1, 2.5},
                    .unit = "mm",
                    .size = Index3{64, 65, 66},
                    .type = SampleType::i16,
                    .endian = InputConfig::Endian::big,
                    .header_bytes = 512};
  expected.work = {.directory = "/scratch/a",
                   .chunk = 64,
                   .brick = 128,
                   .shard = 1,
                   .copy = WorkConfig::Copy::never};
  expected.surface = {.isovalue = std::nullopt,
                      .inside = SurfaceConfig::Inside::below,
                      .border = SurfaceConfig::Border::open,
                      .gradient = SurfaceConfig::Gradient::central};
  expected.simplify = {.enabled = false,
                       .tolerance = 2,
                       .tolerance_unit = SimplifyConfig::Unit::physical,
                       .metric = SimplifyConfig::Metric::sum,
                       .topology = SimplifyConfig::Topology::free,
                       .qef = SimplifyConfig::Qef::normal};
  expected.output = {.directory = "/out",
                     .formats = {"glb"},
                     .merged = OutputConfig::Merged::always,
                     .tiles = false,
                     .tile_vertices = 2048,
                     .precision = 0.5,
                     .normals = false,
                     .report = false};
  expected.run = {.executor = RunConfig::Executor::slurm, .threads = 3, .memory = 512U << 20};
  expected.slurm = {.partition = "long,short",
                    .account = "imaging",
                    .qos = "normal",
                    .time = "1-12:30",
                    .cpus_per_task = 16,
                    .mem = std::uint64_t{2} << 30,
                    .max_array = 200,
                    .max_running = 50,
                    .shards_per_task = 8,
                    .retries = 0,
                    .extra = {"--constraint=avx2", "-x node7", "--exclusive"},
                    .prologue = {"module load gcc/12", "", "export A='b c'"}};
  EXPECT_EQ(config, expected);
}

TEST(Config, OneSpacingIsThree) {
  EXPECT_EQ(parse(least_config("input.spacing = 2")).input.spacing, (Vec3{2, 2, 2}));
}

TEST(Config, FormatsAreInOneOrder) {
  EXPECT_EQ(parse(least_config("output.formats = [\"glb\", \"drc\"]")),
            parse(least_config("output.formats = [\"drc\", \"glb\"]")));
}

TEST(Config, ReadsAFileBesideWhichThePathsLie) {
  const testing::TempDirectory directory;
  const auto path = directory / "head.toml";
  write(path, least_config());
  const Config config = load_config(path);
  EXPECT_EQ(config.input.path, directory / "scan.nrrd");
  EXPECT_EQ(config.work.directory, directory / "head.work");
  EXPECT_EQ(config.output.directory, directory / "head.mesh");
  write(directory / "head", least_config());
  EXPECT_EQ(load_config(directory / "head").work.directory, directory / "head.work");
  write(directory / "head.v2.toml", least_config());
  EXPECT_EQ(load_config(directory / "head.v2.toml").work.directory, directory / "head.v2.work");
}

TEST(Config, RefusesFilesThatAreNoConfig) {
  const testing::TempDirectory directory;
  const auto message = [](const std::filesystem::path& path) -> std::string {
    return testing::error_text<InputError>([&] { load_config(path); });
  };
  const std::string none = (directory / "none.toml").string();
  EXPECT_EQ(message(none),
            none + ": no such config file; check the path, or write one with `voxweld init`");
  EXPECT_EQ(
      message(directory.path()),
      directory.path().string() + ": expected a config file (TOML), found a directory or device");
  write(directory / "volume.raw", std::string(1U << 21, 'x'));
  EXPECT_EQ(message(directory / "volume.raw"),
            (directory / "volume.raw").string() +
                ": expected a config file (TOML) of at most 1MiB, found 2097152 bytes; a volume is "
                "named inside the config, as input.path");
}

TEST(Config, SlurmTimesAreSlurms) {
  for (const char* time : {"0", "90", "4:30", "4:00:00", "1-0", "1-12:30", "07-23:59:59"})
    EXPECT_EQ(parse(least_config(), {std::string("slurm.time=\"") + time + "\""}).slurm.time, time);
}

TEST(Config, SlurmMayChoose) {
  const Config config = parse(
      least_config("slurm.mem = \"auto\"\nslurm.shards_per_task = \"auto\"\nslurm.extra = []\n"));
  EXPECT_EQ(config.slurm, SlurmConfig{});
  EXPECT_EQ(config.slurm.mem, 0U);
  EXPECT_EQ(config.slurm.shards_per_task, 0);
}

TEST(Config, MakesBricksThatFitTheMemory) {
  const auto brick = [](const std::string& keys) { return parse(least_config(keys)).work.brick; };
  EXPECT_EQ(brick(""), 64);
  EXPECT_EQ(brick("run.memory = \"1GiB\"\n"), 64);
  EXPECT_EQ(brick("run.memory = \"1023MiB\"\n"), 32);
  EXPECT_EQ(brick("run.memory = \"256MiB\"\n"), 32);
  EXPECT_EQ(brick("run.memory = \"255MiB\"\n"), 16);
  EXPECT_EQ(brick("run.memory = \"64MiB\"\nwork.brick = 128\n"), 128);
  EXPECT_EQ(brick("run.memory = \"64MiB\"\nwork.shard = 16\n"), 32);
  // Chunks that are given divide shards.
  EXPECT_EQ(brick("run.memory = \"64MiB\"\nwork.chunk = 128\n"), 32);
  EXPECT_EQ(brick("run.memory = \"64MiB\"\nwork.chunk = 64\nwork.shard = 1\n"), 64);
  const Config little = parse(least_config("run.memory = \"64MiB\"\nwork.shard = 1\n"));
  EXPECT_EQ(little.work.brick, 16);
  EXPECT_EQ(little.work.chunk, 16);
}

// Whatever the bytes, the answer is a config or one InputError.
TEST(Config, SurvivesDamagedText) {
  const std::string whole = least_config("work.chunk = 64\noutput.formats = [\"glb\"]\n");
  const auto attempt = [](const std::string& text) {
    try {
      parse(text);
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("/data/scan.toml"));
    }
  };
  for (std::size_t size = 0; size < whole.size(); ++size) attempt(whole.substr(0, size));
  for (std::size_t at = 0; at < whole.size(); ++at) {
    for (const char c : {'\0', '\n', '"', '[', '\xff', '.', '='}) {
      std::string text = whole;
      text[at] = c;
      attempt(text);
    }
  }
  attempt(least_config("work.chunk = " + std::string(100000, '[')));
  attempt(std::string(100000, 'x') + " = 1");
}

TEST(Bytes, ReadsUnits) {
  EXPECT_EQ(parse_bytes("4GiB"), std::uint64_t{4} << 30);
  EXPECT_EQ(parse_bytes("1.5 TiB"), std::uint64_t{3} << 39);
  EXPECT_EQ(parse_bytes("500MB"), 500000000U);
  EXPECT_EQ(parse_bytes("7kb"), 7000U);
  EXPECT_EQ(parse_bytes("9007199254740993B"), 9007199254740993U);
  for (const char* wrong :
       {"", "4", "GiB", "4G", "-4GiB", "4GiBs", "4 Gi B", "1e3KB", "nanB", "99999999TiB",
        "9999999999999999999999B", "1.5e300TB", "+4GiB", " 4GiB"})
    EXPECT_EQ(parse_bytes(wrong), std::nullopt) << wrong;
  for (const std::uint64_t bytes :
       {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{1000}, std::uint64_t{3} << 40,
        (std::uint64_t{1} << 63) - 1, std::uint64_t{1536} << 20})
    EXPECT_EQ(parse_bytes(bytes_text(bytes)), bytes) << bytes_text(bytes);
}

TEST(Config, AnAddressOfAServerIsNoPath) {
  const Config config = testing::parse(
      "[input]\npath = \"https://a.org//x/../b.zarr?k=1\"\n[surface]\nisovalue = 1\n");
  EXPECT_EQ(config.input.path.string(), "https://a.org//x/../b.zarr?k=1");
}

}  // namespace
}  // namespace voxweld
