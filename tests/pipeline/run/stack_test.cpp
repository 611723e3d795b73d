// An image stack through the pipeline: the image library is loaded where images are read, and by no
// stage after that.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "pipeline/output/verify.h"
#include "storage/image/image_file.h"
#include "storage/manifest/manifest.h"
#include "tests/pipeline/run/program.h"
#include "tests/support/temp_directory.h"

namespace voxweld::testing {
namespace {

constexpr int slice_side = 24;

void write_slice(const std::filesystem::path& folder, int z) {
  std::vector<std::byte> pixels;
  for (int y = 0; y < slice_side; ++y)
    for (int x = 0; x < slice_side; ++x) {
      const int dx = x - 12, dy = y - 11, dz = z - 10;
      pixels.push_back(static_cast<std::byte>(dx * dx + dy * dy + dz * dz < 70 ? 220 : 20));
    }
  write_png(folder / ("slice_" + std::to_string(z) + ".png"), {slice_side, slice_side, 1}, pixels);
}

class Stack : public ::testing::Test {
 protected:
  Stack() {
    std::filesystem::create_directories(directory_ / "slices");
    for (int z = 0; z < slice_side; ++z) write_slice(directory_ / "slices", z);
    std::ofstream(directory_ / "stack.toml") << "[input]\npath = \"slices\"\nspacing = [1.0, 1.0, "
                                                "1.5]\n[surface]\nisovalue = \"otsu\"\n";
  }
  // Runs one command with the dynamic linker telling which files it maps.
  ProgramResult traced(const std::string& command) const {
    setenv("LD_DEBUG", "files", 1);
    ProgramResult result = run_voxweld({command, (directory_ / "stack.toml").string()});
    unsetenv("LD_DEBUG");
    return result;
  }
  static bool loads_images(const ProgramResult& result) {
    return result.err.find("libOpenImageIO") != std::string::npos;
  }

  TempDirectory directory_;
};

TEST_F(Stack, OnlyIngestLoadsTheImageLibrary) {
  const ProgramResult ingest = traced("ingest");
  ASSERT_EQ(ingest.exit_code, 0) << ingest.err;
  EXPECT_TRUE(loads_images(ingest));
  for (const char* stage : {"build", "merge", "stitch", "refine", "seams", "mend", "remend",
                            "retile", "encode", "run"}) {
    const ProgramResult result = traced(stage);
    ASSERT_EQ(result.exit_code, 0) << stage;
    EXPECT_FALSE(loads_images(result)) << stage;
  }
  const VerifyReport report = verify_output(directory_ / "stack.mesh");
  EXPECT_TRUE(report.good()) << to_text(report);
}

TEST_F(Stack, AChangedOrAddedSliceIsNoticed) {
  ASSERT_EQ(traced("run").exit_code, 0);
  write_slice(directory_ / "slices", slice_side);
  const ProgramResult longer = traced("run");
  EXPECT_TRUE(loads_images(longer));
  EXPECT_EQ(read_manifest(directory_ / "stack.mesh" / manifest_name).frame.size,
            (Index3{slice_side, slice_side, slice_side + 1}));
  std::filesystem::remove(directory_ / "slices" / "slice_7.png");
  const ProgramResult gap = run_voxweld({"run", (directory_ / "stack.toml").string()});
  EXPECT_EQ(gap.exit_code, 2);
  EXPECT_NE(gap.err.find('7'), std::string::npos) << gap.err;
}

std::uint64_t ran(const std::filesystem::path& output, const std::string& stage) {
  const Manifest manifest = read_manifest(output / manifest_name);
  for (const auto& entry : *manifest.stages)
    if (entry.at("stage") == stage) return entry.at("ran");
  return 0;
}

// Slice 20 lies in the upper of two layers of shards.
// Where nothing is to be learnt of the whole volume first, as its noise is.
TEST_F(Stack, ABadSliceStopsItsLayerAlone) {
  const std::vector<std::string> run = {"run",   (directory_ / "stack.toml").string(),
                                        "--set", "work.brick=16",
                                        "--set", "work.shard=1",
                                        "--set", "work.chunk=16",
                                        "--set", "surface.isovalue=100",
                                        "--set", "surface.gradient=central"};
  // Two layers of bricks and one of the ring: 2 x 2 x 2 shards, store and octrees alike.
  const auto slice = directory_ / "slices" / "slice_20.png";
  std::filesystem::resize_file(slice, std::filesystem::file_size(slice) - 30);
  const ProgramResult failed = run_voxweld(run);
  EXPECT_EQ(failed.exit_code, 2);
  EXPECT_NE(failed.err.find("slice_20.png"), std::string::npos) << failed.err;
  EXPECT_NE(failed.err.find("4 of 8 shards of the input cannot be read"), std::string::npos)
      << failed.err;
  write_slice(directory_ / "slices", 20);
  const ProgramResult mended = run_voxweld(run);
  ASSERT_EQ(mended.exit_code, 0) << mended.err;
  EXPECT_EQ(ran(directory_ / "stack.mesh", "ingest"), 4u);
  const VerifyReport report = verify_output(directory_ / "stack.mesh");
  EXPECT_TRUE(report.good()) << to_text(report);
}

}  // namespace
}  // namespace voxweld::testing
