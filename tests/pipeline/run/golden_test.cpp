// The bytes each stage leaves, held against recorded hashes. Resume takes an artifact for current
// when its key is, and the key has the stage's version in it: so whoever changes what a stage
// writes has to raise its version, and this test says so.
#include <draco/core/draco_version.h>

#include <cstdlib>
#include <fstream>

#include "pipeline/encode/encode_stage.h"
#include "stages/build/label_edge.h"
#include "storage/artifact/cube_mesh_artifact.h"
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
    VOXWELD_EXPECT_DONE(scene_->run({"simplify.topology=safe", "work.brick=16", "work.shard=2",
                                     "output.tile_vertices=1024", "simplify.tolerance=0.05"}));
  }
  static void TearDownTestSuite() { scene_.reset(); }
  static std::vector<std::filesystem::path> work(const std::string& ending) {
    return files_ending(scene_->work(), ending);
  }
  static std::unique_ptr<Scene> scene_;
};
std::unique_ptr<Scene> Goldens::scene_;

TEST_F(Goldens, Build) {
  expect_recorded({"build", 15, "e89ed61f33a9fd37d38f85a98ca6f9bc"}, shard_version,
                  hash_of(work(".octree"), shard_kind, shard_version));
}

TEST_F(Goldens, Merge) {
  expect_recorded({"merge", 10, "b69e3c8f6ca3b8f6aa0e4b42f380fc1f"}, top_version,
                  hash_of(work(".tree"), top_kind, top_version));
}

TEST_F(Goldens, Stitch) {
  expect_recorded({"stitch", 6, "8237b4f4dcb81211d64a2837118c0463"}, tile_version,
                  hash_of(work(".tile"), tile_kind, tile_version));
}

TEST_F(Goldens, Encode) {
  if (std::string(draco::kDracoVersion) != "1.5.5")
    GTEST_SKIP() << "the hashes are of Draco 1.5.5's bytes, this is " << draco::kDracoVersion;
  auto files = files_ending(scene_->output(), ".drc");
  const auto glb = files_ending(scene_->output(), ".glb");
  files.insert(files.end(), glb.begin(), glb.end());
  expect_recorded({"encode", 6, "0bf1421c488e4c56dae565abe430ca3f"}, encode_version,
                  hash_of(files));
}

// What build, merge and stitch leave of a run.
void expect_stages(const Scene& scene, const Golden& build, const Golden& merge,
                   const Golden& stitch) {
  const auto work = [&](const char* ending) { return files_ending(scene.work(), ending); };
  expect_recorded(build, shard_version, hash_of(work(".octree"), shard_kind, shard_version));
  expect_recorded(merge, top_version, hash_of(work(".tree"), top_kind, top_version));
  expect_recorded(stitch, tile_version, hash_of(work(".tile"), tile_kind, tile_version));
}

// The same surface, each sheet by itself.
TEST(SheetGoldens, OfEveryStage) {
  const Scene scene(scene_volume());
  VOXWELD_EXPECT_DONE(scene.run(
      {"work.brick=16", "work.shard=2", "output.tile_vertices=1024", "simplify.tolerance=0.2"}));
  expect_stages(scene, {"build", 15, "1be4381c150c3685096c4803803a2f3d"},
                {"merge", 10, "27ab206b2324925258f63c351d04ebae"},
                {"stitch", 6, "2b9db126f3532d24ac8f325f12931e4d"});
}

// The same surface, refined.
void expect_refined(const char* topology, const Golden& cubes, const Golden& tiles) {
  const Scene scene(scene_volume());
  VOXWELD_EXPECT_DONE(scene.run({std::string("simplify.topology=") + topology,
                                 "simplify.refine=collapse", "work.brick=16", "work.shard=2",
                                 "output.tile_vertices=1024", "simplify.tolerance=0.2"}));
  constexpr std::uint32_t version = refine_version << 16 | cube_mesh_version;
  expect_recorded(cubes, version,
                  hash_of(files_ending(scene.work(), ".cubes"), cube_mesh_kind, cube_mesh_version));
  expect_recorded(tiles, tile_version,
                  hash_of(files_ending(scene.work(), ".tile"), tile_kind, tile_version));
}

TEST(RefinedGoldens, OfEveryStage) {
  expect_refined(
      "manifold",
      {"stitch, refine, seams, mend and remend", 983046, "8014a0b748b759b1cfec606ee669d5c9"},
      {"retile", 6, "64f439da6179b04752d8fe8ba75d23a3"});
}

TEST(RefinedGoldens, OfSafeCollapse) {
  expect_refined(
      "safe",
      {"stitch, refine, seams, mend and remend", 983046, "f3efea0c7bb5b0c3d50c70dcc1273eb2"},
      {"retile", 6, "8f6e6473f5ee3175b53ac7729ab86917"});
}

// Two labels that share a ball, one below it, specks; an edit gives one more, another replaces.
RawVolume label_volume() {
  return volume_of({45, 41, 37}, [](Index3 p) -> std::int64_t {
    const Index3 d = p - Index3{20, 19, 18};
    const bool speck = (p.x * 7 + p.y * 13 + p.z * 29) % 97 == 0;
    if (speck) return 3;
    if (d.x * d.x + d.y * d.y + d.z * d.z > 230) return p.z < 9 ? 5 : 0;
    return d.x + d.y / 2 + d.z / 3 > 2 ? 3 : 7;
  });
}

const char* const label_edits =
    "\n[[edit]]\nop = \"add\"\nmaterial = 11\nshape = \"box\"\ncenter = [24.3, 15.2, 20.1]\n"
    "size = [11, 13.5, 40]\n[[edit]]\nop = \"replace\"\nmaterial = 5\nshape = \"sphere\"\n"
    "center = [14.5, 25.5, 18.25]\nradius = 7.75\n";

// The same labels, refined.
void expect_refined_labels(const Settings& mode, const Golden& cubes, const Golden& tiles) {
  const Scene scene(label_volume());
  std::ofstream(scene.config(), std::ios::app) << label_edits;
  VOXWELD_EXPECT_DONE(scene.run(mode + Settings{"simplify.refine=collapse", "work.brick=16",
                                                "work.shard=2", "output.tile_vertices=1024"}));
  constexpr std::uint32_t version = refine_version << 16 | cube_mesh_version;
  expect_recorded(cubes, version,
                  hash_of(files_ending(scene.work(), ".cubes"), cube_mesh_kind, cube_mesh_version));
  expect_recorded(tiles, tile_version,
                  hash_of(files_ending(scene.work(), ".tile"), tile_kind, tile_version));
}

TEST(RefinedGoldens, OfEachLabel) {
  expect_refined_labels(
      {"labels.mode=each"},
      {"stitch, refine, seams, mend and remend", 983046, "97491fa6ef128ab02fde9955d190680f"},
      {"retile", 6, "3a16e31bb855e3916e46a474afbd8e2f"});
  expect_refined_labels(
      {"labels.mode=each", "simplify.topology=safe"},
      {"stitch, refine, seams, mend and remend", 983046, "76bcdfe5cf52559f75e25f1711924a5d"},
      {"retile", 6, "46f39a20822c367e2cf09d7288991098"});
}

TEST(RefinedGoldens, OfSharedLabels) {
  expect_refined_labels(
      {"labels.mode=shared"},
      {"stitch, refine, seams, mend and remend", 983046, "fe00efe3bcf788625b4eb4378ccde30f"},
      {"retile", 6, "ecd9135a0d12c8c805926e0083ae547c"});
}

// Each of these labels by itself, and of it each sheet.
TEST(SheetGoldens, OfEachLabel) {
  const Scene scene(label_volume());
  std::ofstream(scene.config(), std::ios::app) << label_edits;
  VOXWELD_EXPECT_DONE(scene.run(
      {"labels.mode=each", "work.brick=16", "work.shard=2", "output.tile_vertices=1024"}));
  expect_stages(scene, {"build", 15, "48eb0696e50755302a4b8e59eb94ca2c"},
                {"merge", 10, "f8c36157ee94ddf57630ea326592208f"},
                {"stitch", 6, "53616ec95bdc1afb7c252a0526a66345"});
}

// The versions in the key of a build of labels: of the artifacts, and of the estimate.
constexpr std::uint32_t label_build_version = 100 * shard_version + label_estimate_version;
// A row for each stage: what the artifacts and the files of a mode are.
struct LabelGolden {
  const char* mode;
  std::array<Golden, 4> stages;  // build, merge, stitch, encode
};

void PrintTo(const LabelGolden& golden, std::ostream* out) {
  *out << golden.mode;
}

class LabelGoldens : public ::testing::TestWithParam<LabelGolden> {};

TEST_P(LabelGoldens, OfEveryStage) {
  const LabelGolden& golden = GetParam();
  const Scene scene(label_volume());
  std::ofstream(scene.config(), std::ios::app) << label_edits;
  VOXWELD_EXPECT_DONE(scene.run({std::string("labels.mode=") + golden.mode,
                                 "simplify.topology=safe", "work.brick=16", "work.shard=2",
                                 "output.tile_vertices=1024", "simplify.tolerance=0.05"}));
  const auto work = [&](const char* ending) { return files_ending(scene.work(), ending); };
  expect_recorded(golden.stages[0], label_build_version,
                  hash_of(work(".octree"), shard_kind, shard_version));
  expect_recorded(golden.stages[1], top_version, hash_of(work(".tree"), top_kind, top_version));
  expect_recorded(golden.stages[2], tile_version, hash_of(work(".tile"), tile_kind, tile_version));
  if (std::string(draco::kDracoVersion) != "1.5.5")
    GTEST_SKIP() << "the hashes are of Draco 1.5.5's bytes, this is " << draco::kDracoVersion;
  auto files = files_ending(scene.output(), ".drc");
  for (const char* ending : {".glb", "labels.jsonl", "tiles.jsonl"})
    for (const auto& file : files_ending(scene.output(), ending)) files.push_back(file);
  expect_recorded(golden.stages[3], encode_version, hash_of(files));
}

INSTANTIATE_TEST_SUITE_P(
    Modes, LabelGoldens,
    ::testing::Values(
        LabelGolden{"each",
                    {Golden{"build of each label", 1502, "af3275bf64bb74582d202c62405322a6"},
                     {"merge of each label", 10, "38e6c977a186cd71ffc695238ad7c19a"},
                     {"stitch of each label", 6, "59cdc8ffcee04a094002ca747ffecbbb"},
                     {"encode of each label", 6, "1b9b2d2959d13b7ddf4174ab40da0909"}}},
        LabelGolden{"shared",
                    {Golden{"build of shared labels", 1502, "d1612ff6a60749ddbbad424cef6adadf"},
                     {"merge of shared labels", 10, "2ad601b431d9438617387eef5b1c8d58"},
                     {"stitch of shared labels", 6, "05d69da8e8cc4a33c37bdd751c8c158f"},
                     {"encode of shared labels", 6, "90c12958e47f9a413fc30528bae518ba"}}}),
    [](const auto& each) { return each.param.mode; });

}  // namespace
}  // namespace voxweld::testing
