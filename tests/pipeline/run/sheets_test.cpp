// simplify.topology = "manifold": each sheet collapses by itself.
#include "stages/whole/contour_volume.h"
#include "storage/artifact/tile_artifact.h"
#include "tests/pipeline/run/label_volumes.h"
#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {
namespace {

// Slabs, one of them thinner than two voxels, and a ball that cuts into them.
RawVolume slabs() {
  return volume_of({70, 66, 61}, [](Index3 p) {
    const auto slab = [&](std::int64_t at, std::int64_t half) {
      const std::int64_t off = std::abs(20 * p.z + 3 * p.x + 5 * p.y - at);
      return std::min(
          {half - off, 10 * (p.x - 4), 10 * (63 - p.x), 10 * (p.y - 4), 10 * (59 - p.y)});
    };
    const Index3 d = p - Index3{33, 31, 29};
    const std::int64_t ball = 150 - (d.x * d.x + d.y * d.y + d.z * d.z);
    return std::clamp<std::int64_t>(128 + std::max({slab(700, 13), slab(1000, 70), ball}), 0, 255);
  });
}

const Settings by_sheets = {"simplify.tolerance=0.3"};  // the default
const Settings small_bricks = {"work.brick=16", "work.shard=2", "output.tile_vertices=1024"};

ContourParameters parameters(Topology topology) {
  ContourParameters made;
  made.surface.isovalue = {128.0};
  made.surface.gradient = Gradient::central;
  made.simplify.tolerance = 0.3;
  made.simplify.topology = topology;
  return made;
}
VolumeContour in_memory(const RawVolume& volume, Topology topology) {
  return contour_volume({volume.type, volume.size, volume.samples}, parameters(topology),
                        {6, 1024, 0.01});
}

TEST(Sheets, TilesAreThoseOfAVolumeInMemory) {
  const RawVolume volume = slabs();
  const Scene scene(volume);
  VOXWELD_EXPECT_DONE(scene.run(by_sheets + small_bricks + Settings{"surface.gradient=central"}));
  const VolumeContour expected = in_memory(volume, Topology::manifold);
  const auto files = files_ending(scene.work(), ".tile");
  std::size_t triangles = 0, vertices = 0;
  std::map<std::uint64_t, const TileMesh*> tiles;
  for (const TileMesh& tile : expected.tiles) tiles[tile.tile.code()] = &tile;
  ASSERT_EQ(files.size(), tiles.size());
  for (const auto& file : files) {
    const TileMesh mesh = TileArtifact(file).read();
    const TileMesh& other = *tiles.at(mesh.tile.code());
    EXPECT_EQ(mesh.ids, other.ids);
    EXPECT_EQ(mesh.positions, other.positions);
    EXPECT_EQ(mesh.triangles, other.triangles);
    triangles += mesh.triangles.size();
    vertices += mesh.ids.size();
  }
  EXPECT_GT(files.size(), 1u);
  EXPECT_GT(triangles, 1000u);
  expect_good(scene.output());
  EXPECT_EQ(manifest_of(scene.output())["counts"]["vertices"], expected.counts.vertices);
}

TEST(Sheets, LeaveFewerTrianglesThanSafeCollapse) {
  const Scene scene(slabs());
  const auto triangles = [&](const Settings& settings) {
    VOXWELD_EXPECT_DONE(scene.run(settings));
    expect_good(scene.output());
    return manifest_of(scene.output())["counts"]["triangles"].get<std::uint64_t>();
  };
  const std::uint64_t safe = triangles({"simplify.tolerance=0.3", "simplify.topology=safe"});
  EXPECT_LT(triangles(by_sheets) * 4, safe * 3);
}

// What lies above the bricks differs with their size; the mesh and its counts do not.
TEST(Sheets, CollapseAboveBricks) {
  const Scene scene(slabs());
  const Settings common = by_sheets + Settings{"output.tile_vertices=1024"};
  scene.expect_one_tree(common,
                        {Settings{"work.brick=16", "work.shard=1"},
                         Settings{"work.brick=16", "work.shard=4", "work.chunk=16"},
                         Settings{"work.brick=32", "work.shard=1"}, Settings{"work.brick=64"},
                         Settings{"work.brick=128", "run.memory=8GiB"},
                         Settings{"work.brick=256", "run.memory=64GiB"}});
  VOXWELD_EXPECT_DONE(scene.run(common + Settings{"work.brick=16", "work.shard=1"}));
  EXPECT_GT(manifest_of(scene.output())["counts"]["collapsed_above_bricks"], 0);
}

// Unless they are told how large to be.
TEST(Sheets, BricksFitTheMemory) {
  const Scene surface(slabs()), labels(cell_labels({40, 36, 33}, 5, 0.003, 21));
  for (const char* memory : {"run.memory=1GiB", "run.memory=256MiB", "run.memory=128MiB"}) {
    VOXWELD_EXPECT_DONE(surface.run_in(memory, by_sheets + Settings{memory}));
    EXPECT_EQ(text_of_file(surface.output(memory) / "mesh.drc"),
              text_of_file(surface.output("run.memory=1GiB") / "mesh.drc"));
    for (const char* mode : {"labels.mode=each", "labels.mode=shared"})
      VOXWELD_EXPECT_DONE(labels.run_in(memory, {mode, memory}));
  }
  expect_refused(surface.run(by_sheets + Settings{"run.memory=256MiB", "work.brick=64"}),
                 "raise run.memory or lower work.brick");
}

TEST(Sheets, OfOneLabel) {
  const Scene scene(cell_labels({40, 36, 33}, 5, 0.003, 21));
  const Settings common = {"surface.label=2", "surface.isovalue=2", "simplify.topology=manifold",
                           "simplify.tolerance=0.5"};
  scene.expect_one_tree(common, {small_bricks, Settings{"work.brick=32"}});
  VOXWELD_EXPECT_DONE(scene.run(common));
  expect_good(scene.output());
}

TEST(Sheets, OfEachLabelAreThoseOfARunOfItAlone) {
  const Settings sheets = {"simplify.topology=manifold", "simplify.tolerance=0.5"};
  expect_labels_as_alone(cell_labels({70, 60, 50}, 6, 0.03, 1), sheets + small_bricks, 4);
  expect_labels_as_alone(cell_labels({34, 33, 20}, 4, 1.0, 2), sheets + small_bricks, 3);
  // Their octrees collapse above the bricks, and above the shards.
  const RawVolume slabs = volume_of({140, 140, 130}, [](Index3 at) {
    return at.z < 40 ? 3 : 16 * at.z + at.x < 1440 ? 200 : at.y < 70 ? 7 : 0;
  });
  expect_labels_as_alone(slabs, sheets + Settings{"work.brick=16", "work.shard=1"}, 0);
  const Scene scene(slabs);
  const Settings common = sheets + Settings{"labels.mode=each", "output.tile_vertices=1024"};
  scene.expect_one_tree(common, {Settings{"work.brick=16", "work.shard=1", "work.chunk=16"},
                                 Settings{"work.brick=16", "work.shard=4", "run.threads=1"},
                                 Settings{"work.brick=32", "work.shard=2"}});
  VOXWELD_EXPECT_DONE(scene.run(common + Settings{"work.brick=16", "work.shard=1"}));
  EXPECT_GT(manifest_of(scene.output())["counts"]["collapsed_above_bricks"], 0);
}

// Where several labels meet there are no sheets to tell apart.
TEST(Sheets, OfSharedLabelsCollapseSafely) {
  const Scene scene(cell_labels({20, 20, 20}, 5, 0.003, 21));
  const Settings common = {"labels.mode=shared"};
  EXPECT_EQ(difference(scene.clean_tree(common + Settings{"simplify.topology=safe"}),
                       scene.clean_tree(common + Settings{"simplify.topology=manifold"})),
            "");
}

}  // namespace
}  // namespace voxweld::testing
