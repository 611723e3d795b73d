// labels.mode = "shared", end to end: one complex of all labels of a volume.
#include <csignal>
#include <fstream>
#include <map>
#include <set>

#include "pipeline/output/load.h"
#include "pipeline/output/verify.h"
#include "storage/manifest/manifest.h"
#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;

// Columns of labels that lean, some up to the border, 0 around a ball.
RawVolume foam(SampleType type, Index3 size) {
  const std::uint64_t more = sample_bytes(type) == 8 ? std::uint64_t{1} << 62 : 0;
  return integer_volume(type, size, [&](Index3 s) {
    const Index3 d = s * 2 - size;
    if (d.x * d.x + d.y * d.y + d.z * d.z >= size.x * size.x * 5 / 4) return std::uint64_t{0};
    return static_cast<std::uint64_t>(1 + (s.x + s.z / 3) / 13 + 10 * ((s.y + s.x / 5) / 11)) +
           more;
  });
}

const Settings shared = {"labels.mode=shared"};

std::set<MaterialPair> pairs_of(const fs::path& mesh) {
  const DecodedMesh decoded = load_mesh(mesh);
  return {decoded.pairs.begin(), decoded.pairs.end()};
}

TEST(SharedLabelsRun, EachLabelsEdgesBalance) {
  for (const SampleType type : {SampleType::u8, SampleType::i16, SampleType::u64}) {
    const Scene scene(foam(type, {47, 40, 41}));
    VOXWELD_EXPECT_DONE(
        scene.run(shared + Settings{"work.brick=16", "work.shard=2", "output.tile_vertices=1024"}));
    const VerifyReport report = expect_good(scene.output());
    EXPECT_GT(report.tiles, 1u);
    EXPECT_GT(report.seam_vertices, 0u);
    EXPECT_TRUE(report.merged_checked);
    EXPECT_EQ(read_manifest(scene.output() / manifest_name).labels, LabelMode::shared);
    EXPECT_EQ(pairs_of(scene.output() / "mesh.drc"), pairs_of(scene.output() / "mesh.glb"));
    EXPECT_GT(pairs_of(scene.output() / "mesh.drc").size(), 20u);
  }
}

TEST(SharedLabelsRun, EveryPartitionGivesTheSameBytes) {
  for (const Index3 size : {Index3{48, 40, 33}, Index3{32, 32, 32}}) {
    const Scene scene(foam(SampleType::u16, size));
    const Settings common = shared + Settings{"output.tile_vertices=1024"};
    scene.expect_one_tree(
        common, {Settings{"work.brick=16", "work.shard=1", "work.chunk=16"},
                 Settings{"work.brick=16", "work.shard=2", "work.copy=true", "work.chunk=8"},
                 Settings{"work.brick=32", "work.shard=1", "work.copy=true", "run.threads=1"}});
  }
}

// Bricks that the store's ranges tell to be of one label, or outside of all, are not read.
TEST(SharedLabelsRun, BricksOfOneLabelAreKnownWithoutTheirSamples) {
  const Scene scene(volume_of({96, 80, 80}, [](Index3 at) {
    if (at.z > 60) return 0;
    return at.x < 50 ? 3 : at.y < 37 ? 7 : 200;
  }));
  const Settings common = shared + Settings{"work.brick=16", "output.tile_vertices=1024"};
  const Tree read = scene.clean_tree(common);
  const Settings copied = common + Settings{"work.copy=true", "work.chunk=16"};
  EXPECT_EQ(difference(read, scene.clean_tree(copied)), "");
  // An edit that changes a brick in the middle of a label, and what was known with it.
  std::ofstream(scene.config(), std::ios::app)
      << "[[edit]]\nshape = \"sphere\"\ncenter = [24, 24, 24]\nradius = 5\nmaterial = 9\n";
  EXPECT_EQ(difference(scene.clean_tree(common), scene.clean_tree(copied)), "");
}

TEST(SharedLabelsRun, NoiseBalancesToo) {
  RawVolume volume = noise_volume({40, 33, 21}, 7);
  for (std::byte& sample : volume.samples) sample &= std::byte{7};
  const Scene scene(volume);
  for (const char* border : {"surface.border=closed", "surface.border=open"}) {
    VOXWELD_EXPECT_DONE(
        scene.run(shared + Settings{"work.brick=16", "output.tile_vertices=4096", border}));
    const VerifyReport report = expect_good(scene.output());
    EXPECT_EQ(report.boundary_edges > 0, std::string(border).ends_with("open"));
  }
}

TEST(SharedLabelsRun, KilledAtAnyMomentItEndsInTheSameBytes) {
  const Scene scene(foam(SampleType::u16, {60, 50, 44}));
  const Settings settings = shared + Settings{"work.brick=16", "work.shard=1", "work.chunk=16",
                                              "output.tile_vertices=1024"};
  const Tree clean = scene.clean_tree(settings);
  const ProgramResult timing = scene.run_in("timing", settings);
  VOXWELD_EXPECT_DONE(timing);
  for (const double part : {0.2, 0.5, 0.8}) {
    const ProgramResult killed = scene.run(settings, Stop{SIGKILL, part * timing.seconds});
    if (killed.exit_code != 128 + SIGKILL) fs::remove_all(scene.output());
  }
  VOXWELD_EXPECT_DONE(scene.run(settings));
  EXPECT_EQ(difference(clean, output_tree(scene.output())), "");
}

TEST(SharedLabelsRun, LabelsAreListedWithWhatTheyEnclose) {
  const Scene scene(foam(SampleType::u16, {47, 40, 41}));
  VOXWELD_EXPECT_DONE(scene.run(shared + Settings{"output.tile_vertices=1024"}));
  std::map<Material, std::uint64_t> voxels;
  const RawVolume volume = foam(SampleType::u16, {47, 40, 41});
  for (std::size_t i = 0; i < volume.samples.size(); i += 2)
    ++voxels[std::to_integer<unsigned>(volume.samples[i]) |
             std::to_integer<unsigned>(volume.samples[i + 1]) << 8];
  voxels.erase(0);
  LabelListReader labels(scene.output() / labels_name);
  double sum = 0, expected = 0;
  Material last = 0;
  std::size_t count = 0;
  while (const auto label = labels.next()) {
    EXPECT_GT(label->label, last);
    last = label->label;
    ASSERT_TRUE(voxels.contains(label->label));
    ASSERT_TRUE(label->volume.has_value());
    const auto size = static_cast<double>(voxels[label->label]);
    EXPECT_NEAR(*label->volume, size, 0.1 * size + 30) << label->label;
    EXPECT_GT(label->area, 0);
    EXPECT_GT(label->vertices, 3u);
    EXPECT_GT(label->tiles, 0u);
    ASSERT_TRUE(label->bounds.has_value());
    for (int a = 0; a < 3; ++a) EXPECT_LT(label->bounds->lo[a], label->bounds->hi[a]);
    sum += *label->volume;
    expected += size;
    ++count;
  }
  EXPECT_EQ(count, voxels.size());
  EXPECT_EQ(read_manifest(scene.output() / manifest_name).counts.labels, count);
  EXPECT_NEAR(sum, expected, 0.01 * expected);
}

TEST(SharedLabelsRun, ADamagedFileIsFound) {
  const Scene scene(foam(SampleType::u8, {40, 36, 33}));
  VOXWELD_EXPECT_DONE(scene.run(shared + Settings{"output.tile_vertices=1024"}));
  // Another label on one triangle of a tile: the file decodes, and its hash tells.
  const fs::path tile = fs::directory_iterator(scene.output() / "tiles")->path();
  std::vector<std::byte> bytes = read_whole_file(tile);
  bytes[bytes.size() / 2] ^= std::byte{1};
  write_whole_file(tile, bytes, Durability::rename_only);
  EXPECT_FALSE(verify_output(scene.output()).good());
}

// Solid modelling with materials: a run with edits gives the bytes of one from scratch, and an edit
// builds the shards it reaches alone.
TEST(SharedLabelsRun, EditsOfEmptySpaceAndOfLabels) {
  const std::string edits =
      "[[edit]]\nshape = \"box\"\nmaterial = 3\ncenter = [30, 30, 30]\nsize = [31, 25, 22]\n"
      "[[edit]]\nop = \"replace\"\nshape = \"sphere\"\nmaterial = 9\ncenter = [40, 38, 36]\n"
      "radius = 9.5\n";
  const std::string cut =
      "[[edit]]\nop = \"subtract\"\nshape = \"sphere\"\ncenter = [19, 20, 22]\nradius = 4\n";
  const TempDirectory folder;
  const auto run = [&](const std::string& name, const std::string& input, const std::string& text) {
    const fs::path config = folder / (name + ".toml");
    const std::string all = "[input]\n" + input +
                            "[labels]\nmode = \"shared\"\n[work]\nbrick = 16\nshard = 1\n"
                            "chunk = 16\n[output]\ntile_vertices = 1024\n" +
                            text;
    write_whole_file(config, as_bytes(all), Durability::rename_only);
    const ProgramResult result = run_voxweld({"run", config.string()});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    expect_good(folder / (name + ".mesh"));
    return output_tree(folder / (name + ".mesh"));
  };
  const RawVolume volume = foam(SampleType::u8, {62, 62, 62});
  write_whole_file(folder / "foam.raw", volume.samples, Durability::rename_only);
  const std::string empty = "format = \"empty\"\nsize = [62, 62, 62]\n";
  const std::string labels =
      "path = \"foam.raw\"\nformat = \"raw\"\nsize = [62, 62, 62]\ntype = \"uint8\"\n";
  for (const std::string& input : {empty, labels}) {
    const Tree before = run("edited", input, edits), after = run("edited", input, edits + cut);
    EXPECT_NE(difference(before, after), "");
    fs::remove_all(folder / "fresh.work");
    fs::remove_all(folder / "fresh.mesh");
    EXPECT_EQ(difference(run("fresh", input, edits + cut), after), "");
    EXPECT_EQ(difference(before, run("edited", input, edits)), "");
    EXPECT_TRUE(pairs_of(folder / "edited.mesh" / "mesh.drc").contains({3, 9}));
    fs::remove_all(folder / "edited.work");
    fs::remove_all(folder / "edited.mesh");
  }
}

TEST(SharedLabelsRun, WhatCannotBeIsRefused) {
  const auto refused = [](const RawVolume& volume, const Settings& settings,
                          const std::string& words) {
    const Scene scene(volume);
    const ProgramResult result = scene.run(settings);
    expect_refused(result, words);
  };
  const RawVolume volume = foam(SampleType::u8, {20, 20, 20});
  refused(volume, shared + Settings{"surface.label=3", "surface.isovalue=3"},
          "labels.mode chooses labels too");
  refused(volume, shared + Settings{"simplify.topology=free"}, "labels keep their topology");
  RawVolume real{{8, 8, 8}, SampleType::f32, std::vector<std::byte>(8 * 8 * 8 * 4), 0};
  refused(real, shared, "labels are integers");
  RawVolume none{{8, 8, 8}, SampleType::u8, std::vector<std::byte>(8 * 8 * 8), 0};
  refused(none, shared, "none of the 1 labels");
}

}  // namespace
}  // namespace voxweld::testing
