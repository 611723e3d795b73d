#include "stages/encode/lattice_mesh.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <map>

#include "storage/support/error.h"
#include "tests/support/shapes.h"

namespace voxweld {
namespace {

TEST(LatticeMesh, WeldsByExactCoordinates) {
  DecodedMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {9, 9, 9}};
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  const LatticeMesh welded = weld(mesh, testing::small_lattice());
  EXPECT_EQ(welded.positions.size(), 4u);  // the unused one is gone
  EXPECT_EQ(welded.triangles, (std::vector<Triangle>{{0, 1, 2}, {1, 3, 2}}));
  EXPECT_EQ(welded.positions[1], (LatticePoint{192, 128, 128}));
}

TEST(LatticeMesh, RefusesPositionsOffTheLattice) {
  DecodedMesh mesh;
  mesh.triangles = {{0, 1, 2}};
  for (const float bad : {0.01f, -2.5f, 1000.0f, std::numeric_limits<float>::quiet_NaN(),
                          std::numeric_limits<float>::infinity()}) {
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, bad, 0}};
    EXPECT_THROW(weld(mesh, testing::small_lattice()), FormatError) << bad;
  }
}

TEST(LatticeMesh, DigestTellsSetsOfTrianglesApart) {
  const TileMesh torus = testing::make_torus({}, testing::small_lattice());
  const LatticeMesh mesh{torus.positions, torus.triangles};
  LatticeMesh changed = mesh;
  std::reverse(changed.triangles.begin(), changed.triangles.end());
  for (Triangle& t : changed.triangles) t = {t[1], t[2], t[0]};
  EXPECT_EQ(digest(changed), digest(mesh));
  std::swap(changed.triangles[7][0], changed.triangles[7][1]);
  EXPECT_NE(digest(changed), digest(mesh));
  changed = mesh;
  ++changed.positions[5][2];
  EXPECT_NE(digest(changed), digest(mesh));
  changed = mesh;
  changed.triangles.pop_back();
  EXPECT_NE(digest(changed), digest(mesh));
}

TEST(LatticeMesh, PointIndexNumbersByFirstUse) {
  EXPECT_TRUE(rc::check([](const std::vector<std::uint8_t>& values) {
    PointIndex index;
    std::map<LatticePoint, std::uint32_t> expected;
    for (const std::uint8_t v : values) {
      const LatticePoint q{v % 5, v / 5 % 7, -(v / 35)};
      RC_ASSERT(index.find(q) ==
                (expected.contains(q) ? expected.at(q) : std::uint32_t{PointIndex::none}));
      const auto number =
          expected.try_emplace(q, static_cast<std::uint32_t>(expected.size())).first->second;
      RC_ASSERT(index.add(q) == number);
    }
    RC_ASSERT(index.points().size() == expected.size());
  }));
}

}  // namespace
}  // namespace voxweld
