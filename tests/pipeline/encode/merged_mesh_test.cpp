// The merged mesh among the units of encode: when it is made, from what, and how it is stopped.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <atomic>

#include "pipeline/encode/asset_work.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "tests/pipeline/encode/encoded_scene.h"

namespace voxweld {
namespace {

using ::testing::HasSubstr;

const std::vector<std::string> many_tiles = {"output.tile_vertices=1024", "simplify.enabled=false"};

std::vector<std::byte> merged_file(const EncodeJob& job) {
  return read_whole_file(job.output / "mesh.drc");
}

// Files of two bytes: how often it is called is all that is asked.
std::atomic<int> calls{0};
InterruptFlag stop;
void write_two_bytes(Asset&, const ByteSink& sink) {
  ++calls;
  sink(std::array<std::byte, 2>{});
}
constexpr MeshWriter counting{"counting", ".two", false, 0, write_two_bytes, nullptr};

// Holds the merged mesh, or two tiles, but lacks a megabyte for the merged mesh and a tile.
std::uint64_t memory_for_one_or_the_other(const Config& config, const EncodeJob& job) {
  const TopArtifact top(job.stitch->merge->path());
  const auto plan = unit_plan(top, LabelMode::off);
  std::uint64_t tile = 0;
  for (const PlannedTile& planned : plan->largest_tiles())
    tile = std::max(tile, encode_bytes(config, planned));
  return program_bytes() + plan_merged(config, *plan).bytes + tile - (std::uint64_t{1} << 20);
}

TEST(MergedMesh, IsAUnitAmongTheTilesWhereMemoryHoldsBoth) {
  testing::EncodedScene scene(many_tiles);
  const EncodeJob job = scene.job("beside");
  scene.encode(job);
  const StageReport& report = scene.context().reports.back();
  EXPECT_GT(report.ran, 2u);
  EXPECT_THAT(scene.shown(),
              HasSubstr(fmt::format("encode: {} tiles and the merged mesh\n", report.ran - 1)));
}

TEST(MergedMesh, IsMadeAloneWhereMemoryDoesNotHoldBoth) {
  testing::EncodedScene scene(many_tiles);
  const EncodeJob beside = scene.job("beside"), alone = scene.job("alone");
  scene.encode(beside);
  const std::uint64_t ran = scene.context().reports.back().ran;
  Config& config = scene.context().config;
  config.run.memory = memory_for_one_or_the_other(config, alone);
  scene.encode(alone);
  ASSERT_EQ(scene.context().reports.size(), 1u);
  EXPECT_EQ(scene.context().reports.back().ran, ran);
  EXPECT_EQ(merged_file(alone), merged_file(beside));
}

TEST(MergedMesh, OfOneTileIsNotEncodedAgain) {
  testing::EncodedScene scene;
  EncodeJob job = scene.job("one");
  job.formats = {counting};
  calls = 0;
  scene.encode(job);
  EXPECT_EQ(calls, 1);
  EXPECT_EQ(read_whole_file(job.output / "mesh.two").size(), 2u);
  // Without files of the tile there is nothing to take them from.
  job = scene.job("merged_only");
  job.formats = {counting};
  scene.context().config.output.tiles = false;
  calls = 0;
  scene.encode(job);
  EXPECT_EQ(calls, 1);
  EXPECT_EQ(read_whole_file(job.output / "mesh.two").size(), 2u);
}

TEST(MergedMesh, StopsBetweenItsFormats) {
  testing::EncodedScene scene(many_tiles);
  EncodeJob job = scene.job("stopped");
  job.formats = {{"stopping", ".one", false, 0,
                  [](Asset&, const ByteSink& sink) {
                    stop.request();
                    sink(std::array<std::byte, 1>{});
                  },
                  nullptr},
                 counting};
  const TopArtifact top(job.stitch->merge->path());
  const auto plan = unit_plan(top, LabelMode::off);
  RunOptions options;
  options.interrupt = &stop;
  calls = 0;
  EXPECT_THROW(encode_merged(scene.context(), job, *plan, WorkerContext(0, options)), Interrupted);
  EXPECT_EQ(calls, 0);
  EXPECT_FALSE(merged_is_current(job, *plan));
}

}  // namespace
}  // namespace voxweld
