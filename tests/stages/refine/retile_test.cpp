// Tiles of a refined mesh: each triangle in one of them, and one order of all.
#include "stages/refine/retile.h"

#include <gtest/gtest.h>

#include "stages/refine/mesh_part.h"
#include "tests/stages/refine/torus.h"

namespace voxweld {
namespace {

using testing::shuffled;
using testing::torus;
using testing::torus_frame;
using testing::with_sides;

TileMesh tile_of(const RefineMesh& mesh, CellKey tile) {
  const CubeLattice blocks = tile_blocks(torus_frame());
  MeshGather part;
  part.add(mesh, [&](std::size_t t) { return belongs_to(mesh, t, blocks, tile); });
  return to_tile_mesh(part.mesh(), tile, torus_frame().lattice, blocks);
}

std::vector<std::array<std::uint64_t, 3>> ids_of(const TileMesh& mesh) {
  std::vector<std::array<std::uint64_t, 3>> ids;
  for (const auto& t : mesh.triangles)
    ids.push_back({mesh.ids[t[0]].bits, mesh.ids[t[1]].bits, mesh.ids[t[2]].bits});
  return ids;
}

TEST(Retile, TilesInOrderAreTheWholeInOrder) {
  const RefineMesh mesh = torus();
  const TileMesh whole = tile_of(mesh, {8, {}});
  EXPECT_EQ(whole.triangles.size(), mesh.triangles.size());
  EXPECT_EQ(whole.polygon_triangles, mesh.triangles.size());
  EXPECT_EQ(whole.quads, 0u);
  EXPECT_EQ(whole.corner_normals.size(), mesh.triangles.size());
  for (const int level : {4, 5, 7}) {
    std::vector<std::array<std::uint64_t, 3>> ids;
    const std::uint64_t tiles = std::uint64_t{1} << (3 * (8 - level));
    for (std::uint64_t code = 0; code < tiles; ++code) {
      const TileMesh tile = tile_of(mesh, {level, morton_decode(code)});
      EXPECT_EQ(tile.lattice, torus_frame().lattice);
      const auto part = ids_of(tile);
      ids.insert(ids.end(), part.begin(), part.end());
    }
    EXPECT_EQ(ids, ids_of(whole)) << level;
  }
}

TEST(Retile, TheOrderOfTheMeshDoesNotMatter) {
  const TileMesh one = tile_of(torus(), {7, {}}), other = tile_of(shuffled(torus(), 3), {7, {}});
  EXPECT_EQ(one.positions, other.positions);
  EXPECT_EQ(one.ids, other.ids);
  EXPECT_EQ(one.normals, other.normals);
  EXPECT_EQ(one.triangles, other.triangles);
  EXPECT_EQ(one.corner_normals, other.corner_normals);
  EXPECT_FALSE(one.triangles.empty());
}

TEST(Retile, CountsBlocksInOrder) {
  const RefineMesh mesh = torus();
  const CubeLattice blocks = tile_blocks(torus_frame());
  const auto counts = count_blocks(mesh, blocks);
  std::uint64_t all = 0;
  for (const CubeCount& block : counts) {
    all += block.polygons;
    const CellKey key = CellKey::of(block.code, block.level);
    EXPECT_EQ(block.polygons, tile_of(mesh, key).triangles.size());
  }
  EXPECT_EQ(all, mesh.triangles.size());
  EXPECT_TRUE(std::ranges::is_sorted(counts, {}, &CubeCount::code));
}

// There and back the triangles are the same, but for the corner they begin with.
TEST(Retile, FromStitchAndBack) {
  TileMesh stitched = tile_of(torus(), {8, {}});
  for (auto& t : stitched.triangles) std::rotate(t.begin(), t.begin() + 1, t.end());
  stitched.quads = 5;
  const RefineMesh mesh = to_refine_mesh(stitched);
  EXPECT_EQ(testing::shapes_of(mesh), testing::shapes_of(torus()));
}

// The pairs of labels that its own triangles lie between, and each triangle's place in that.
TEST(Retile, BetweenLabels) {
  const RefineMesh mesh = with_sides(torus());
  for (const CellKey key : {CellKey{8, {}}, CellKey{5, {3, 1, 2}}, CellKey{4, {6, 3, 5}}}) {
    const TileMesh tile = tile_of(mesh, key), other = tile_of(shuffled(mesh, 5), key);
    EXPECT_EQ(tile.pairs, other.pairs);
    EXPECT_EQ(tile.triangle_pairs, other.triangle_pairs);
    EXPECT_TRUE(std::ranges::is_sorted(tile.pairs));
    ASSERT_EQ(tile.triangle_pairs.size(), tile.triangles.size());
    std::set<std::uint32_t> used(tile.triangle_pairs.begin(), tile.triangle_pairs.end());
    EXPECT_EQ(used.size(), tile.pairs.size());
    EXPECT_GT(used.size(), 0u);
    // There and back.
    MeshGather part;
    part.add(mesh,
             [&](std::size_t t) { return belongs_to(mesh, t, tile_blocks(torus_frame()), key); });
    EXPECT_EQ(testing::shapes_of(to_refine_mesh(tile)), testing::shapes_of(part.mesh()));
  }
}

// Where labels meet a normal serves both sides: a corner takes it, or its opposite.
TEST(Retile, NormalsBetweenLabelsAreTurnedToTheirTriangle) {
  RefineMesh mesh;
  mesh.positions = {{400, 400, 400}, {420, 400, 400}, {400, 420, 400}, {400, 380, 400}};
  mesh.ids = {{1}, {2}, {3}, {4}};
  const PackedNormal down = pack_normal({0, 0, -1});
  mesh.normals.assign(4, {down, no_normal, no_normal});
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}};
  mesh.sides = {{1, 2}, {1, 3}};
  const TileMesh tile = tile_of(mesh, {8, {}});
  ASSERT_EQ(tile.corner_normals.size(), 2u);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_TRUE(tile.corner_normals[0][k].turned());
    EXPECT_FALSE(tile.corner_normals[1][k].turned());
  }
}

TEST(Retile, WithoutNormals) {
  RefineMesh mesh = torus();
  mesh.normals.clear();
  mesh.positions[mesh.triangles[0][2]] = mesh.positions[mesh.triangles[0][1]];
  const TileMesh tile = tile_of(mesh, {8, {}});
  EXPECT_TRUE(tile.normals.empty());
  EXPECT_TRUE(tile.corner_normals.empty());
  EXPECT_GE(tile.collinear, 1u);
}

}  // namespace
}  // namespace voxweld
