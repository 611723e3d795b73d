#include "stages/refine/cube_ranges.h"

#include <gtest/gtest.h>

#include <map>

#include "stages/refine/cube_lattice.h"
#include "stages/stitch/lattice_plan.h"

namespace voxweld {
namespace {

PlannedTile tile(int level, Index3 at, std::uint64_t vertices) {
  const CellKey key{level, at};
  return {key.code(), static_cast<std::uint32_t>(level), 0, vertices, 2 * vertices};
}

TEST(CubeRanges, OfNoTilesThereAreNone) {
  EXPECT_TRUE(cube_ranges({}).empty());
}

TEST(CubeRanges, HaveEachCubeOnce) {
  // Two tiles in one cube of 64 cells, a large one, and gaps before, between and behind.
  const std::vector<PlannedTile> tiles = {tile(4, {4, 0, 0}, 1), tile(5, {2, 1, 0}, 2),
                                          tile(6, {0, 1, 0}, 4), tile(8, {1, 0, 0}, 8)};
  const auto ranges = cube_ranges(tiles);
  // The large one is cut into its cubes of 64 cells, as there are so few.
  ASSERT_EQ(ranges.size(), 2u + 64u);
  EXPECT_EQ(ranges[0].cubes.begin, 0u);
  EXPECT_EQ(ranges[0].vertices, 3u);
  EXPECT_EQ(ranges[1].cubes.begin, morton_encode({0, 1, 0}));
  EXPECT_EQ(ranges[1].polygons, 8u);
  EXPECT_EQ(ranges[2].cubes.begin, morton_encode({4, 0, 0}));
  EXPECT_EQ(ranges.back().cubes.begin, morton_encode({7, 3, 3}));
  for (std::size_t i = 0; i < ranges.size(); ++i)
    EXPECT_EQ(ranges[i].cubes.end,
              i + 1 < ranges.size() ? ranges[i + 1].cubes.begin : ~std::uint64_t{0});
}

TEST(CubeRanges, OfManyTilesAreTheTiles) {
  std::vector<PlannedTile> tiles;
  for (std::int64_t x = 0; x < 32; ++x) tiles.push_back(tile(8, {x, 0, 0}, 1));
  const auto ranges = cube_ranges(tiles);
  ASSERT_EQ(ranges.size(), 32u);
  EXPECT_EQ(ranges[31].cubes.begin, morton_encode({124, 0, 0}));
}

TEST(CubeRanges, AreCutUpUntilThereAreEnough) {
  const std::vector<PlannedTile> tiles = {tile(8, {0, 0, 0}, 100)};
  EXPECT_EQ(cube_ranges(tiles, 0).size(), 1u);
  EXPECT_EQ(cube_ranges(tiles, 1).size(), 1u);
  EXPECT_EQ(cube_ranges(tiles, 2).size(), 8u);
  EXPECT_EQ(cube_ranges(tiles, 9).size(), 64u);
  EXPECT_EQ(cube_ranges(tiles, 1000).size(), 64u);  // cubes are not cut
}

// The domain of a volume of 256 cells a side and a ring around it has 512, of which seven octants lie beyond.
TEST(CubeRanges, AreNotCutBeyondTheVolume) {
  const std::vector<PlannedTile> tiles = {tile(9, {0, 0, 0}, 800)};
  EXPECT_EQ(cube_ranges(tiles, 2).size(), 8u);
  const CubeGrid cubes{6, 0, splat(256)};
  const auto ranges = cube_ranges(tiles, 2, cubes);
  ASSERT_EQ(ranges.size(), 8u);
  for (std::uint64_t octant = 0; octant < 8; ++octant) {
    EXPECT_EQ(ranges[octant].cubes.begin, octant << 3);
    EXPECT_EQ(ranges[octant].vertices, 100u);
  }
  EXPECT_EQ(ranges[7].cubes.end, ~std::uint64_t{0});  // and all that lies beyond
  EXPECT_EQ(cube_ranges(tiles, 2, {6, 0, {256, 256, 257}}).size(), 2u);
  EXPECT_EQ(cube_ranges(tiles, 9, cubes).size(), 64u);
  // One cell more along z, and there are cubes of 64 on both sides.
  EXPECT_EQ(cube_ranges(tiles, 65, {6, 0, {256, 256, 257}}).size(), 64u + 16u);
}

// A full cube of 64 cells, and a large tile above it where little lies: in the second pass its lowest
// cubes have halves of the full one. What lies further off stays whole.
TEST(CubeRanges, AreCutUpBesideFullCubes) {
  std::vector<PlannedTile> tiles;
  for (std::int64_t z = 0; z < 2; ++z)
    for (std::int64_t y = 0; y < 2; ++y)
      for (std::int64_t x = 0; x < 2; ++x) tiles.push_back(tile(6, {x, y, z}, 1000));
  tiles.push_back(tile(7, {1, 0, 0}, 100));
  tiles.push_back(tile(8, {1, 0, 0}, 100));
  const auto ranges = cube_ranges(tiles, 0);
  // The tile of 2^7 cells would have four halves.
  ASSERT_EQ(ranges.size(), 8u + 8u + 1u);
  EXPECT_EQ(ranges[8].cubes.begin, morton_encode({2, 0, 0}));
  EXPECT_EQ(ranges[9].cubes.begin, morton_encode({3, 0, 0}));
  EXPECT_EQ(ranges[16].cubes.begin, morton_encode({4, 0, 0}));
  // One half is less than a full one.
  const std::vector<PlannedTile> few = {tile(6, {1, 1, 1}, 1000), tile(7, {1, 0, 0}, 100)};
  EXPECT_EQ(cube_ranges(few, 0).size(), 2u);
}

// Full cubes up to a power of two, where cubes of the second pass lie beyond: all of them come behind the
// last tile.
TEST(CubeRanges, BeginBeyondTilesToo) {
  std::vector<PlannedTile> tiles;
  for (std::uint64_t cube = 0; cube < 64; ++cube)
    tiles.push_back(tile(6, morton_decode(cube), 800));
  EXPECT_EQ(cube_ranges(tiles, 0).size(), 64u);
  EXPECT_EQ(cube_ranges(tiles, 0, {6, 4}).size(), 64u);  // the domain ends there
  const auto ranges = cube_ranges(tiles, 0, {6, 8});
  EXPECT_GT(ranges.size(), 64u + 8u);
  EXPECT_LT(ranges.size(), 64u + 61u);           // 5^3 - 4^3 cubes, of which several go together
  std::map<std::uint64_t, std::uint64_t> loads;  // by the range's begin
  for (std::int64_t z = 0; z <= 4; ++z)
    for (std::int64_t y = 0; y <= 4; ++y)
      for (std::int64_t x = 0; x <= 4; ++x) {
        const std::uint64_t code = morton_encode({x, y, z});
        std::uint64_t load = 0;  // of the tiles whose octants it has
        for (int octant = 0; octant < 8; ++octant) {
          const Index3 below = Index3{x, y, z} - Index3{octant & 1, octant >> 1 & 1, octant >> 2};
          const auto inside = [](std::int64_t v) { return v >= 0 && v < 4; };
          load += inside(below.x) && inside(below.y) && inside(below.z) ? 100 : 0;
        }
        for (const PlannedRange& range : ranges)
          if (range.cubes.contains(code)) loads[range.cubes.begin] += load;
      }
  for (const auto& [begin, load] : loads) EXPECT_LE(load, 800u) << begin;
}

// What a cube of a small volume is cut by does not depend on where the volume ends.
TEST(CubeLattice, WholeCubesGoOnBeyondTheVolume) {
  for (const int pass : {0, 1}) {
    const RefineFrame small{plan_lattice({splat(100), {1, 1, 1}, 0.01}), {1, 1, 1}, {}, splat(100)};
    RefineFrame large = small;
    large.size = splat(1000);
    const CubeLattice cubes(small, pass), others(large, pass);
    each_index({{}, splat(2)}, [&](Index3 cube) {
      const LatticeBox whole = cubes.whole(cube);
      EXPECT_EQ(whole.common(cubes.bounds()), cubes.box(cube));
      EXPECT_EQ(whole, others.whole(cube));
      const double side = 64 / small.lattice.step;
      for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(whole.hi[a] + 1 - whole.lo[a], side, 1);
      if (pass == 1 && cube.x == 0) {
        EXPECT_LT(whole.lo[0], 0);
        EXPECT_EQ(cubes.box(cube).lo[0], 0);
      }
    });
  }
}

}  // namespace
}  // namespace voxweld
