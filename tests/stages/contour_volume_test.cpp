// What stages/whole promises who embeds it; contour_test.cpp has the meshes' properties.
#include "stages/whole/contour_volume.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "storage/support/error.h"
#include "tests/support/contour_in_memory.h"
#include "tests/support/mesh_check.h"

namespace voxweld {
namespace {

// The header's example, as it stands there but for what is done with the vertices.
TEST(ContourVolume, TheExampleIsABall) {
  const std::int64_t side = 96;
  std::vector<float> samples;
  for (std::int64_t z = 0; z < side; ++z)
    for (std::int64_t y = 0; y < side; ++y)
      for (std::int64_t x = 0; x < side; ++x)
        samples.push_back(static_cast<float>(20 - 0.5 * std::hypot(x - 48, y - 48, z - 48)));
  ContourParameters parameters;
  parameters.spacing = {0.5, 0.5, 0.5};
  parameters.simplify.tolerance = 0.05;  // mm, as is all that follows
  const VolumeContour contour = contour_volume(
      {SampleType::f32, {side, side, side}, std::as_bytes(std::span(samples))}, parameters);
  const TileMesh mesh = join_tiles(contour.tiles);
  EXPECT_TRUE(testing::summarize(mesh.triangles).sound());
  EXPECT_EQ(testing::summarize(mesh.triangles).euler, 2);
  EXPECT_LT(mesh.triangles.size(), 20000u);  // is simplified
  ASSERT_FALSE(mesh.positions.empty());
  for (const LatticePoint& q : mesh.positions)
    EXPECT_NEAR(
        std::hypot(mesh.lattice.coordinate(0, q[0]) - 24, mesh.lattice.coordinate(1, q[1]) - 24,
                   mesh.lattice.coordinate(2, q[2]) - 24),
        20, 0.1);
}

testing::MemoryVolume noise(Index3 size) {
  std::mt19937 random(5);
  return testing::MemoryVolume::made<std::uint8_t>(size, SampleType::u8,
                                                   [&](Index3) { return random(); });
}

ContourParameters above(double isovalue) {
  ContourParameters p;
  p.surface.isovalue = isovalue;
  return p;
}

TEST(ContourVolume, TilesJoinedAreTheOneTile) {
  const testing::MemoryVolume volume = noise({40, 21, 35});
  ContourOptions options{4, 1024, 0.01};
  const VolumeContour cut = contour_volume(volume, above(128), options);
  ASSERT_GT(cut.tiles.size(), 4u);
  ASSERT_EQ(cut.tiles.size(), cut.plan.size());
  options.tile_vertices = 1 << 30;
  const VolumeContour whole = contour_volume(volume, above(128), options);
  ASSERT_EQ(whole.tiles.size(), 1u);
  const TileMesh joined = join_tiles(cut.tiles);
  EXPECT_EQ(joined.positions, whole.tiles[0].positions);
  EXPECT_EQ(joined.triangles, whole.tiles[0].triangles);
  EXPECT_EQ(joined.normals, whole.tiles[0].normals);
  EXPECT_EQ(joined.positions, testing::weld_tiles(cut.tiles).vertices) << "ids are places";
}

// Doubles do not hold such samples, but what they are above the isovalue.
TEST(ContourVolume, OfLarge64BitIntegersIsThatOfSmallOnes) {
  const auto ball = [](Index3 at) {
    const auto d = at - Index3{9, 10, 11};
    return 300 - (d.x * d.x + d.y * d.y + d.z * d.z);
  };
  const Index3 size{20, 20, 22};
  const auto mesh = [&](const testing::MemoryVolume& volume, const Isovalue& isovalue) {
    ContourParameters p;
    p.surface.isovalue = isovalue;
    return join_tiles(contour_volume(volume, p).tiles);
  };
  const TileMesh small =
      mesh(testing::MemoryVolume::made<std::int32_t>(size, SampleType::i32, ball), 255);
  ASSERT_FALSE(small.triangles.empty());
  for (const std::int64_t base : {std::int64_t{1} << 62, -(std::int64_t{1} << 60)}) {
    const TileMesh large =
        mesh(testing::MemoryVolume::made<std::int64_t>(size, SampleType::i64,
                                                       [&](Index3 at) { return base + ball(at); }),
             Isovalue::of(base + 255));
    EXPECT_EQ(large.positions, small.positions) << base;
    EXPECT_EQ(large.triangles, small.triangles) << base;
    EXPECT_EQ(large.normals, small.normals) << base;
  }
  const std::uint64_t base = std::uint64_t{1} << 63;
  const TileMesh highest =
      mesh(testing::MemoryVolume::made<std::uint64_t>(
               size, SampleType::u64,
               [&](Index3 at) { return base + static_cast<std::uint64_t>(ball(at) + 3000); }),
           Isovalue::of(base + 3255));
  EXPECT_EQ(highest.positions, small.positions);
}

TEST(ContourVolume, OptionsReachTheMesh) {
  const testing::MemoryVolume volume = noise({20, 20, 20});
  ContourOptions options{4, 1024, 0.01};
  options.normals = false;
  options.first = {16, 0, -32};
  const TileMesh moved = join_tiles(contour_volume(volume, above(128), options).tiles);
  options.first = {};
  options.normals = true;
  const TileMesh mesh = join_tiles(contour_volume(volume, above(128), options).tiles);
  EXPECT_TRUE(moved.corner_normals.empty());
  EXPECT_EQ(mesh.corner_normals.size(), mesh.triangles.size());
  EXPECT_EQ(moved.triangles, mesh.triangles);
  ASSERT_FALSE(mesh.positions.empty());
  const auto place = [](const TileMesh& m, int axis) {
    return m.lattice.coordinate(axis, m.positions[0][static_cast<std::size_t>(axis)]);
  };
  EXPECT_EQ(place(moved, 0) - place(mesh, 0), 16);
  EXPECT_EQ(place(moved, 2) - place(mesh, 2), -32);
  options.precision = 1e-12;
  EXPECT_THROW(contour_volume(volume, above(128), options), InputError);
}

// As one who edits a volume step by step does.
TEST(ContourVolume, BricksMayBeBuiltAnew) {
  testing::MemoryVolume volume = noise({50, 33, 34});
  const ContourOptions options{4, 1024, 0.01};
  VolumeBricks bricks = build_bricks(volume, above(128), options);
  for (std::size_t i = 0; i < 40; ++i) volume.samples[i] = std::byte{255};  // row 0 of slice 0
  const BrickGrid grid = bricks.grid();
  const HaloBlock block{volume.type,           volume.size,   {{}, volume.size},
                        volume.samples.data(), volume.size.x, volume.size.x * volume.size.y};
  BrickScratch scratch;
  for (std::int64_t x = 0; x < grid.bricks().x; ++x)
    build_brick(block, place_of_brick(grid, {x, 0, 0}), above(128), scratch,
                bricks.octrees.at(morton_encode({x, 0, 0})));
  const TileMesh mesh = join_tiles(contour_bricks(bricks).tiles);
  const TileMesh anew = join_tiles(contour_volume(volume, above(128), options).tiles);
  EXPECT_EQ(mesh.positions, anew.positions);
  EXPECT_EQ(mesh.triangles, anew.triangles);
}

TEST(ContourVolume, EachLabelIsItsOwnVolume) {
  testing::MemoryVolume volume = noise({20, 35, 18});
  for (std::byte& sample : volume.samples) sample = std::byte(std::to_integer<int>(sample) / 100);
  ContourParameters each;
  each.labels.mode = LabelMode::each;
  each.labels.rules = std::make_shared<const MaterialRules>();
  const ContourOptions options{4, 1024, 0.01};
  const auto labels = build_label_bricks(volume, each, options);
  ASSERT_EQ(labels.size(), 3u);
  for (const auto& [material, bricks] : labels) {
    ContourParameters alone;
    alone.surface.label = material;
    const TileMesh mesh = join_tiles(contour_bricks(bricks).tiles);
    const TileMesh expected = join_tiles(contour_volume(volume, alone, options).tiles);
    EXPECT_EQ(mesh.positions, expected.positions) << material;
    EXPECT_EQ(mesh.triangles, expected.triangles) << material;
  }
}

}  // namespace
}  // namespace voxweld
