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

// Cubes share the vertices of triangles that leave one: once these are there, no others.
TEST_P(Pieces, AreTheSameWithTheirLastPartsAddedQuickly) {
  const RefineMesh mesh = torus();
  MeshGather plain, quick;
  std::vector<CubePiece> pieces;
  each_piece(mesh, CubeLattice(torus_frame(), GetParam()),
             [&](const CubePiece& piece) { pieces.push_back(piece); });
  for (const CubePiece& piece : pieces) {
    plain.add(piece.leaving);
    quick.add(piece.leaving);
  }
  for (const CubePiece& piece : pieces) {
    plain.add(piece.inside);
    quick.add_last(piece.inside);
  }
  EXPECT_EQ(quick.mesh().ids, plain.mesh().ids);
  EXPECT_EQ(quick.mesh().triangles, plain.mesh().triangles);
  EXPECT_EQ(quick.mesh().samples, plain.mesh().samples);
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

// A patch stands in place of what lies in its boxes.
TEST(RemoveInside, TakesOutWhatLiesInOneBox) {
  const RefineMesh before = with_sides(torus());
  LatticeBox lower = LatticeBox::around(before.positions), upper = lower;
  const std::int32_t middle = (lower.lo[0] + lower.hi[0]) / 2;
  lower.hi[0] = middle - 1;
  lower.lo[1] = (lower.lo[1] + lower.hi[1]) / 2;
  upper.lo[0] = middle;
  const auto lies_in = [](const LatticeBox& box, const LatticeBox& triangle) {
    return box.contains(triangle.lo) && box.contains(triangle.hi);
  };
  RefineMesh after = before;
  for (std::uint32_t t = 0; t < before.triangles.size(); t += 5) after.intersecting.push_back(t);
  remove_inside(after, {upper, lower});
  std::uint32_t left = 0, across = 0;
  SampleReader old_samples(before), samples(after);
  for (std::uint32_t t = 0; t < before.triangles.size(); ++t) {
    const LatticeBox box = before.box(t);
    if (lies_in(lower, box) || lies_in(upper, box)) continue;
    across += lower.meets(box) && upper.meets(box) ? 1 : 0;
    ASSERT_LT(left, after.triangles.size());
    EXPECT_EQ(after.triangles[left], before.triangles[t]);
    EXPECT_EQ(after.sides[left], before.sides[t]);
    EXPECT_EQ(after.intersects(left), t % 5 == 0);
    std::vector<LatticePoint> old_points, points;
    old_samples.each(t, [&](const SurfaceSample& s) { old_points.push_back(s.point); });
    samples.each(left, [&](const SurfaceSample& s) { points.push_back(s.point); });
    EXPECT_EQ(points, old_points);
    ++left;
  }
  EXPECT_EQ(after.triangles.size(), left);
  EXPECT_EQ(after.sides.size(), left);
  EXPECT_GT(across, 0u) << "a triangle with corners in both boxes stays";
  EXPECT_LT(left, before.triangles.size() / 2);
}

}  // namespace
}  // namespace voxweld
