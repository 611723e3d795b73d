// labels.mode = "each" on random volumes, in memory: every label's mesh by itself is closed and
// 2-manifold, by our own check and by OpenMesh, of the same topology at any tolerance, and together
// they enclose the volume.
#include <gtest/gtest.h>

#include <random>

#include "pipeline/output/openmesh_check.h"
#include "tests/support/contour_in_memory.h"
#include "tests/support/mesh_check.h"
#include "tests/support/random_volumes.h"

namespace voxweld::testing {
namespace {

const ContourOptions small_tiles{4, 1024, 0.01};

struct LabelMesh {
  LatticeMesh mesh;
  double volume = 0;
};

LabelMesh mesh_of(const VolumeBricks& bricks) {
  const std::vector<TileMesh> tiles = contour_bricks(bricks).tiles;
  LatticeWeld weld = weld_tiles(tiles);
  LabelMesh label{{std::move(weld.vertices), std::move(weld.triangles)}, 0};
  std::vector<Vec3> places;
  for (const LatticePoint& q : label.mesh.positions)
    places.push_back(place_of(tiles[0].lattice, q));
  label.volume = signed_volume(places, label.mesh.triangles);
  return label;
}

ContourParameters of_each(const Edits& edits) {
  ContourParameters parameters;
  parameters.labels.mode = LabelMode::each;
  parameters.labels.rules = std::make_shared<const MaterialRules>();  // 0 is a label like others
  parameters.edits = edits;
  return parameters;
}

void expect_sound(const LabelMesh& label, Material material) {
  SCOPED_TRACE("label " + std::to_string(material));
  const MeshSummary summary = summarize(label.mesh.triangles);
  EXPECT_TRUE(summary.sound()) << summary;
  EXPECT_TRUE(openmesh_problems(label.mesh, false).empty());
  EXPECT_GT(label.volume, 0);
}

// Regions around random points, cut up by noise.
MemoryVolume random_labels(std::mt19937& random, double noise, int least) {
  const auto below = [&](int end) {
    return static_cast<std::int64_t>(random() % static_cast<unsigned>(end));
  };
  const Index3 size{least + below(17), least + below(17), least + below(17)};
  std::array<Index3, 5> centres;
  for (Index3& centre : centres)
    centre = {below(static_cast<int>(size.x)), below(static_cast<int>(size.y)),
              below(static_cast<int>(size.z))};
  return MemoryVolume::made<std::uint8_t>(size, SampleType::u8, [&](Index3 at) {
    std::size_t nearest = 0;
    const auto distance = [&](std::size_t i) {
      const Index3 d = centres[i] - at;
      return d.x * d.x + d.y * d.y + d.z * d.z;
    };
    for (std::size_t i = 1; i < centres.size(); ++i)
      if (distance(i) < distance(nearest)) nearest = i;
    const bool any = static_cast<double>(below(1000)) < 1000 * noise;
    return any ? below(5) : std::int64_t(nearest);
  });
}

Edits random_edits(std::mt19937& random, Index3 size) {
  std::uniform_real_distribution<double> one(0, 1);
  Edits edits(random() % 3);
  for (Edit& edit : edits) {
    edit.op = std::array{EditOp::add, EditOp::subtract, EditOp::replace}[random() % 3];
    if (edit.op != EditOp::subtract) edit.material = random() % 7;
    edit.solid.shape = random() % 2 == 0 ? SolidShape::sphere : SolidShape::box;
    for (int a = 0; a < 3; ++a) {
      edit.solid.center[a] = one(random) * static_cast<double>(size[a]);
      edit.solid.size[a] = 2 + 12 * one(random);
    }
    edit.solid.radius = 1 + 7 * one(random);
  }
  return edits;
}

TEST(EachLabelOfAnything, IsClosedAndTwoManifoldAtAnyTolerance) {
  const unsigned count = testing::volumes_to_try(18);
  for (unsigned seed = 0; seed < count; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const MemoryVolume volume = random_labels(random, std::array{0.0, 0.05, 1.0}[seed % 3], 3);
    ContourParameters parameters = of_each(random_edits(random, volume.size));
    parameters.simplify.enabled = false;
    const auto uniform = build_label_bricks(volume, parameters, small_tiles);
    std::map<Material, MeshSummary> topology;
    for (const auto& [material, bricks] : uniform) {
      const LabelMesh label = mesh_of(bricks);
      expect_sound(label, material);
      topology[material] = summarize(label.mesh.triangles);
    }
    parameters.simplify.enabled = true;
    for (const double tolerance : {0.1, 3.0}) {
      parameters.simplify.tolerance = tolerance;
      const auto simplified = build_label_bricks(volume, parameters, small_tiles);
      ASSERT_EQ(simplified.size(), uniform.size());
      for (const auto& [material, bricks] : simplified) {
        const LabelMesh label = mesh_of(bricks);
        expect_sound(label, material);
        EXPECT_EQ(summarize(label.mesh.triangles), topology[material]) << "label " << material;
      }
    }
  }
}

// Regions without noise: the meshes are as large as their samples, and fill the volume.
TEST(EachLabelOfAnything, EnclosesItsSamples) {
  for (unsigned seed = 100; seed < 110; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const MemoryVolume volume = random_labels(random, 0, 14);
    std::map<Material, double> samples;
    for (const std::byte sample : volume.samples) samples[std::to_integer<Material>(sample)] += 1;
    double sum = 0;
    for (const auto& [material, bricks] : build_label_bricks(volume, of_each({}), small_tiles)) {
      const double enclosed = mesh_of(bricks).volume, expected = samples.at(material);
      // Edges and corners of small regions are rounded off.
      EXPECT_NEAR(enclosed, expected, 0.15 * expected + 30) << "label " << material;
      sum += enclosed;
    }
    const auto all = static_cast<double>(volume.samples.size());
    EXPECT_GT(sum, 0.85 * all);
    EXPECT_LT(sum, 1.02 * all);
  }
}

}  // namespace
}  // namespace voxweld::testing
