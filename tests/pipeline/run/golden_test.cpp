// The bytes each stage leaves, held against recorded hashes. Resume takes an artifact for current
// when its key is, and the key has the stage's version in it: so whoever changes what a stage
// writes has to raise its version, and this test says so.
#include <draco/core/draco_version.h>

#include <cstdlib>

#include "pipeline/run/encode_stage.h"
#include "storage/artifact/shard_artifact.h"
#include "storage/artifact/tile_artifact.h"
#include "storage/artifact/top_artifact.h"
#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

struct Golden {
  std::string stage;
  std::uint32_t version;
  std::string hash;
};

// A ball, a box that cuts into it, and specks: smooth, flat, sharp and ambiguous places, from
// integers alone.
RawVolume scene_volume() {
  return volume_of({61, 47, 53}, [](Index3 p) {
    const Index3 d = p - Index3{24, 23, 25};
    const std::int64_t ball = 400 - (d.x * d.x + d.y * d.y + d.z * d.z);
    const std::int64_t box =
        12 * std::min({p.x - 31, 52 - p.x, p.y - 9, 37 - p.y, p.z - 6, 33 - p.z});
    const std::int64_t speck = (p.x * 7 + p.y * 13 + p.z * 29) % 97 == 0 ? 90 : 0;
    return std::clamp<std::int64_t>(128 + std::max(ball / 4, box) + speck, 0, 255);
  });
}

std::string hash_of(const std::vector<std::filesystem::path>& files, std::array<char, 4> kind,
                    std::uint32_t version) {
  StreamHasher all;
  for (const auto& file : files) {
    const Hash128 hash = ArtifactReader(file, kind, version).content_hash();
    all.update(std::as_bytes(std::span(&hash, 1)));
  }
  EXPECT_FALSE(files.empty());
  return to_hex(all.finish());
}

std::string hash_of(const std::vector<std::filesystem::path>& files) {
  StreamHasher all;
  for (const auto& file : files) all.update(read_whole_file(file));
  EXPECT_FALSE(files.empty());
  return to_hex(all.finish());
}

void expect_recorded(const Golden& recorded, std::uint32_t version, const std::string& hash) {
  if (recorded.version == version && recorded.hash == hash) return;
  ADD_FAILURE() << recorded.stage
                << (recorded.version == version
                        ? ": the bytes have changed: raise the stage's version, and then record "
                        : ": a new version: record ")
                << "{\"" << recorded.stage << "\", " << version << ", \"" << hash << "\"} here";
}

class Goldens : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    scene_ = std::make_unique<Scene>(scene_volume());
    VOXWELD_EXPECT_DONE(scene_->run(
        {"work.brick=16", "work.shard=2", "output.tile_vertices=1024", "simplify.tolerance=0.05"}));
  }
  static void TearDownTestSuite() { scene_.reset(); }
  static std::vector<std::filesystem::path> work(const std::string& ending) {
    return files_ending(scene_->work(), ending);
  }
  static std::unique_ptr<Scene> scene_;
};
std::unique_ptr<Scene> Goldens::scene_;

TEST_F(Goldens, Build) {
  expect_recorded({"build", 6, "6b654967c5102800f77858f63b5606b3"}, shard_version,
                  hash_of(work(".octree"), shard_kind, shard_version));
}

TEST_F(Goldens, Merge) {
  expect_recorded({"merge", 5, "7dbac32c696eb0a8e67d0adfb55f154d"}, top_version,
                  hash_of(work(".tree"), top_kind, top_version));
}

TEST_F(Goldens, Stitch) {
  expect_recorded({"stitch", 3, "b0677052728a31301b089b6f80595542"}, tile_version,
                  hash_of(work(".tile"), tile_kind, tile_version));
}

TEST_F(Goldens, Encode) {
  if (std::string(draco::kDracoVersion) != "1.5.5")
    GTEST_SKIP() << "the hashes are of Draco 1.5.5's bytes, this is " << draco::kDracoVersion;
  auto files = files_ending(scene_->output(), ".drc");
  const auto glb = files_ending(scene_->output(), ".glb");
  files.insert(files.end(), glb.begin(), glb.end());
  expect_recorded({"encode", 1, "e5a39bfe9b234ac46bb821a3af6db056"}, encode_version,
                  hash_of(files));
}

}  // namespace
}  // namespace voxweld::testing
