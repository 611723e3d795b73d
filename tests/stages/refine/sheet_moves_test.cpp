// What may be done where sheets meet, on meshes small enough to see why.
#include <gtest/gtest.h>

#include "stages/refine/edit_moves.h"

namespace voxweld {
namespace {

constexpr MaterialPair top{1, 2}, middle{2, 3}, bottom{1, 3};

struct Face {
  Corners corners;
  MaterialPair sides;
};

// Vertices are their own ids, so they keep their numbers.
EditMesh mesh_of(const std::vector<LatticePoint>& places, const std::vector<Face>& faces) {
  RefineMesh mesh;
  mesh.positions = places;
  for (std::uint64_t v = 0; v < places.size(); ++v) mesh.ids.push_back({v});
  for (const Face& face : faces) {
    Corners c = face.corners;
    std::rotate(c.begin(), std::ranges::min_element(c), c.end());
    mesh.triangles.push_back(c);
    mesh.sides.push_back(face.sides);
  }
  return {mesh, LatticeBox{{0, 0, 0}, {1000, 1000, 1000}}};
}

// A ball of two halves, their disc a single triangle. 0, 1, 2: its corners; 3, 4, 5 above the edges
// 0 1, 1 2 and 2 0; 6, 7, 8 below them.
EditMesh two_halves() {
  const std::vector<LatticePoint> places = {{100, 100, 200}, {300, 100, 200}, {200, 300, 200},
                                            {200, 80, 300},  {270, 220, 300}, {130, 220, 300},
                                            {200, 80, 100},  {270, 220, 100}, {130, 220, 100}};
  std::vector<Face> faces = {{{0, 1, 2}, middle}};
  const auto cap = [&](std::uint32_t first, bool up) {
    const std::uint32_t a = first, b = first + 1, c = first + 2;
    for (Corners t :
         {Corners{0, 1, a}, {1, 2, b}, {2, 0, c}, {0, a, c}, {1, b, a}, {2, c, b}, {a, b, c}}) {
      if (!up) std::swap(t[1], t[2]);
      faces.push_back({t, up ? top : bottom});
    }
  };
  cap(3, true);
  cap(6, false);
  return mesh_of(places, faces);
}

TEST(SheetMoves, WhereALineIsATriangleNoneOfItsEdgesGoes) {
  const EditMesh mesh = two_halves();
  EditMoves moves(mesh);
  for (const std::uint32_t v : {0u, 1u, 2u}) {
    EXPECT_EQ(mesh.kind(v), StarKind::line);
    EXPECT_EQ(mesh.freedom(v), Freedom::free);
    EXPECT_EQ(mesh.around_edge(v, (v + 1) % 3), 3u);
    ASSERT_TRUE(moves.ends(v, (v + 1) % 3));
    EXPECT_FALSE(moves.linked(v, (v + 1) % 3)) << "the disc would be gone";
  }
}

TEST(SheetMoves, WhatIsOnOneSheetGoesToTheLine) {
  const EditMesh mesh = two_halves();
  EditMoves moves(mesh);
  EXPECT_EQ(mesh.kind(3), StarKind::disc);
  const auto ends = moves.ends(0, 3);
  ASSERT_TRUE(ends);
  EXPECT_EQ(ends->gone, 3u);
  EXPECT_EQ(ends->keep, 0u);
  EXPECT_TRUE(ends->stays);
  EXPECT_TRUE(moves.linked(3, 0));
}

TEST(SheetMoves, EdgesOfALineDoNotFlip) {
  const EditMesh mesh = two_halves();
  EditMoves moves(mesh);
  Change change;
  for (std::uint32_t t = 0; t < mesh.triangles(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh.corners(t)[k], b = mesh.corners(t)[(k + 1) % 3];
      if (a < 3 && b < 3) {
        EXPECT_FALSE(moves.flip(t, k, change)) << a << " " << b;
      }
    }
}

// Two tetrahedra that touch in vertex 0.
TEST(SheetMoves, NoTwoTrianglesGetTheSameCorners) {
  const EditMesh mesh = mesh_of({{500, 500, 500},
                                 {600, 500, 510},
                                 {500, 600, 520},
                                 {530, 540, 600},
                                 {400, 500, 490},
                                 {500, 400, 480},
                                 {470, 460, 400}},
                                {{{0, 2, 1}, top},
                                 {{0, 1, 3}, top},
                                 {{0, 3, 2}, top},
                                 {{1, 2, 3}, top},
                                 {{0, 5, 4}, bottom},
                                 {{0, 4, 6}, bottom},
                                 {{0, 6, 5}, bottom},
                                 {{4, 5, 6}, bottom}});
  EditMoves moves(mesh);
  EXPECT_EQ(mesh.kind(0), StarKind::point);
  for (const std::uint32_t v : {1u, 2u, 3u}) {
    ASSERT_TRUE(moves.ends(0, v));
    EXPECT_EQ(moves.ends(0, v)->gone, v);
    EXPECT_FALSE(moves.linked(v, 0));
  }
}

// Three pages of vertex 0 whose triangles all run the same way, seen from above; two of them lie over
// each other, and one passes through the other.
TEST(SheetMoves, PagesThatPassThroughEachOtherAreFound) {
  const LatticePoint high{586, 550, 505}, low{550, 586, 505};
  for (const bool through : {false, true}) {
    EditMesh mesh = mesh_of({{500, 500, 500},
                             {598, 517, 500},
                             {517, 598, 500},
                             {570, 570, 500},
                             through ? LatticePoint{high[0], high[1], 495} : high,
                             low,
                             {400, 560, 500},
                             {450, 400, 500}},
                            {{{0, 1, 3}, top},
                             {{0, 3, 2}, top},
                             {{0, 1, 4}, middle},
                             {{0, 4, 5}, middle},
                             {{0, 5, 2}, middle},
                             {{0, 2, 6}, bottom},
                             {{0, 6, 7}, bottom},
                             {{0, 7, 1}, bottom}});
    ASSERT_EQ(mesh.kind(0), StarKind::line);
    EXPECT_EQ(!mesh.find_intersecting().empty(), through);
  }
}

}  // namespace
}  // namespace voxweld
