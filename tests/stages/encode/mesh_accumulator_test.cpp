#include "stages/encode/mesh_accumulator.h"

#include <gtest/gtest.h>

#include "storage/support/error.h"
#include "tests/support/shapes.h"

namespace voxweld {
namespace {

TileMesh join(const std::vector<TileMesh>& tiles) {
  MeshAccumulator accumulator;
  for (const TileMesh& tile : tiles) accumulator.append(tile);
  return accumulator.take();
}

TEST(MeshAccumulator, WeldsTilesById) {
  const TileMesh whole = testing::make_torus({}, testing::small_lattice());
  const TileMesh merged = join(testing::cut_into_tiles(whole, 3));
  EXPECT_EQ(merged.positions.size(), whole.positions.size());
  EXPECT_EQ(merged.triangles.size(), whole.triangles.size());
  EXPECT_EQ(merged.corner_normals.size(), whole.triangles.size());
  EXPECT_EQ(merged.normals.size(), whole.normals.size());
  EXPECT_EQ(merged.quads, whole.quads);
}

TEST(MeshAccumulator, DoesNotDependOnWhereTheMeshIsCut) {
  // The same sequence of triangles: all, then cut in the middle of tiles.
  const TileMesh in_order =
      join(testing::cut_into_tiles(testing::make_torus({}, testing::small_lattice()), 2));
  for (const int level : {3, 4, 6}) {
    const TileMesh again = join(testing::cut_into_tiles(in_order, level));
    EXPECT_EQ(again.positions, in_order.positions);
    EXPECT_EQ(again.ids, in_order.ids);
    EXPECT_EQ(again.triangles, in_order.triangles);
    EXPECT_EQ(again.normals, in_order.normals);
    EXPECT_EQ(again.corner_normals, in_order.corner_normals);
  }
}

TEST(MeshAccumulator, RefusesTilesThatDoNotBelongTogether) {
  const auto tiles = testing::cut_into_tiles(testing::make_torus({}, testing::small_lattice()), 3);
  const auto refused = [&](auto change) {
    TileMesh other = tiles[0];
    change(other);
    MeshAccumulator accumulator;
    accumulator.append(tiles[0]);
    EXPECT_THROW(accumulator.append(other), InputError);
  };
  refused([](TileMesh& m) { m.lattice.bits = 15; });
  refused([](TileMesh& m) { m.normals.clear(), m.corner_normals.clear(); });
  refused([](TileMesh& m) {
    for (auto& q : m.positions) ++q[0];
  });
}

}  // namespace
}  // namespace voxweld
