// A mesh cut into pieces by cubes and put together again.
#include "stages/refine/mesh_part.h"

#include <gtest/gtest.h>

#include "tests/stages/refine/torus.h"

namespace voxweld {
namespace {

using testing::shapes_of;
using testing::torus;
using testing::torus_frame;
using testing::with_sides;

class Pieces : public ::testing::TestWithParam<int> {};

TEST_P(Pieces, AreWhatIsAtHomeInEachCube) {
  const RefineMesh mesh = torus();
  const CubeLattice cubes(torus_frame(), GetParam());
  std::vector<std::pair<std::uint64_t, std::uint64_t>> places;
  std::size_t inside = 0, leaving = 0;
  each_piece(mesh, cubes, [&](const CubePiece& piece) {
    places.emplace_back(piece.code, morton_encode(piece.cube));
    EXPECT_EQ(piece.code, cubes.code(piece.cube));
    const LatticeBox box = cubes.box(piece.cube);
    for (std::size_t t = 0; t < piece.inside.triangles.size(); ++t) {
      const LatticeBox triangle = piece.inside.box(t);
      EXPECT_TRUE(box.contains(triangle.lo) && box.contains(triangle.hi));
    }
    for (std::size_t t = 0; t < piece.leaving.triangles.size(); ++t) {
      const LatticeBox triangle = piece.leaving.box(t);
      EXPECT_EQ(home_of(piece.leaving, t, cubes), piece.cube);
      EXPECT_FALSE(box.contains(triangle.lo) && box.contains(triangle.hi));
    }
    inside += piece.inside.triangles.size();
    leaving += piece.leaving.triangles.size();
  });
  EXPECT_TRUE(std::ranges::is_sorted(places));
  EXPECT_GT(places.size(), 10u);
  EXPECT_GT(inside, 0u);
  EXPECT_GT(leaving, 0u);
}

TEST_P(Pieces, TogetherAreTheMesh) {
  const RefineMesh mesh = with_sides(torus());
  MeshGather gather;
  each_piece(mesh, CubeLattice(torus_frame(), GetParam()), [&](const CubePiece& piece) {
    gather.add(piece.leaving);
    gather.add(piece.inside);
  });
  const RefineMesh whole = gather.take();
  EXPECT_EQ(shapes_of(whole), shapes_of(mesh));
  EXPECT_EQ(whole.positions.size(), mesh.positions.size());
  EXPECT_EQ(whole.samples.size(), mesh.samples.size());
  for (const SurfaceSample& sample : whole.samples)
    EXPECT_EQ(whole.positions[whole.triangles[sample.triangle][1]], sample.point);
  EXPECT_TRUE(std::ranges::is_sorted(whole.samples, {}, &SurfaceSample::triangle));
}

INSTANTIATE_TEST_SUITE_P(Passes, Pieces, ::testing::Values(0, 1));

TEST(Gather, TakesWhatItIsTold) {
  const RefineMesh mesh = with_sides(torus());
  MeshGather gather;
  gather.add(mesh, [](std::size_t t) { return t % 2 == 1; });
  const RefineMesh half = gather.take();
  EXPECT_EQ(half.triangles.size(), mesh.triangles.size() / 2);
  EXPECT_EQ(testing::shape_of(half, 0), testing::shape_of(mesh, 1));
  EXPECT_TRUE(gather.mesh().triangles.empty());
}

}  // namespace
}  // namespace voxweld
