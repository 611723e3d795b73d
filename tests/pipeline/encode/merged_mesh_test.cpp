// The merged mesh among the units of encode: when it is made, from what, and how it is stopped.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <atomic>

#include "pipeline/encode/asset_work.h"
#include "pipeline/output/verify.h"
#include "storage/manifest/manifest.h"
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

void take_formats(testing::EncodedScene& scene, EncodeJob& job,
                  const std::vector<std::string>& names) {
  scene.context().config.output.formats = names;
  job.formats = writers_named(mesh_writers(), names);
}

// What the merged mesh takes written tile by tile, and not a megabyte more.
std::uint64_t memory_for_a_stream(Config config, const EncodeJob& job) {
  config.output.formats = {"ply"};
  const TopArtifact top(job.stitch->merge->path());
  return program_bytes() + plan_merged(config, *unit_plan(top, LabelMode::off)).bytes +
         (std::uint64_t{1} << 20);
}

TEST(MergedMesh, IsStreamedWhereMemoryDoesNotHoldIt) {
  testing::EncodedScene scene(many_tiles);
  EncodeJob plenty = scene.job("plenty"), little = scene.job("little");
  const std::vector<std::string> names = {"drc", "ply", "stl", "obj", "vtp"};
  take_formats(scene, plenty, names);
  take_formats(scene, little, names);
  Config& config = scene.context().config;
  scene.encode(plenty);
  const TopArtifact top(little.stitch->merge->path());
  const auto plan = unit_plan(top, LabelMode::off);
  config.run.memory = memory_for_a_stream(config, little);
  const MergedPlan merged = plan_merged(config, *plan);
  EXPECT_TRUE(merged.write);
  EXPECT_EQ(merged.parts, MergedParts::streamed);
  EXPECT_THAT(merged.why_not, HasSubstr("to encode, run.memory is"));
  encode_merged(scene.context(), little, *plan, merged.parts, WorkerContext(0, {}));
  for (const char* file : {"mesh.ply", "mesh.stl", "mesh.obj", "mesh.vtp"})
    EXPECT_EQ(read_whole_file(little.output / file), read_whole_file(plenty.output / file)) << file;
  EXPECT_FALSE(std::filesystem::exists(little.output / "mesh.drc"));
  EXPECT_TRUE(merged_is_current(little, *plan, MergedParts::streamed));
  // With more memory the other format is to come too.
  EXPECT_FALSE(merged_is_current(little, *plan, MergedParts::all));
}

TEST(MergedMesh, InAllFormatsIsListedAndSound) {
  testing::EncodedScene scene(many_tiles);
  EncodeJob job = scene.job("all");
  take_formats(scene, job, {"drc", "glb", "glb-plain", "meshopt", "ply", "stl", "obj", "vtp"});
  scene.encode(job);
  const Manifest manifest = read_manifest(job.output / "manifest.json");
  EXPECT_EQ(*manifest.merged, (MergedFiles{{"drc", "mesh.drc"},
                                           {"glb", "mesh.glb"},
                                           {"glb-plain", "mesh.plain.glb"},
                                           {"meshopt", "mesh.meshopt.glb"},
                                           {"ply", "mesh.ply"},
                                           {"stl", "mesh.stl"},
                                           {"obj", "mesh.obj"},
                                           {"vtp", "mesh.vtp"}}));
  const VerifyReport report = verify_output(job.output);
  EXPECT_TRUE(report.good()) << to_text(report);
  EXPECT_TRUE(report.merged_checked);
}

TEST(MergedMesh, IsLeftOutWhereNoFormatCanBeStreamed) {
  testing::EncodedScene scene(many_tiles);
  const EncodeJob job = scene.job("left_out");
  Config& config = scene.context().config;
  const TopArtifact top(job.stitch->merge->path());
  const auto plan = unit_plan(top, LabelMode::off);
  config.run.memory = memory_for_a_stream(config, job);
  config.output.formats = {"drc", "glb", "glb-plain"};
  const MergedPlan left_out = plan_merged(config, *plan);
  EXPECT_FALSE(left_out.write);
  EXPECT_THAT(left_out.why_not, HasSubstr("to encode, run.memory is"));
  config.output.merged = OutputConfig::Merged::always;
  EXPECT_THROW(plan_merged(config, *plan), InputError);
  config.output.formats = {"ply", "stl"};
  EXPECT_TRUE(plan_merged(config, *plan).write);
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
  EXPECT_THROW(
      encode_merged(scene.context(), job, *plan, MergedParts::all, WorkerContext(0, options)),
      Interrupted);
  EXPECT_EQ(calls, 0);
  EXPECT_FALSE(merged_is_current(job, *plan, MergedParts::all));
}

}  // namespace
}  // namespace voxweld
