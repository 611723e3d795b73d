#include "stages/stitch/quad_split.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace voxweld {
namespace {

using Quad = std::array<QuadCorner, 4>;
constexpr Vec3 up{0, 0, 1}, front{0, -1, 0}, right{1, 0, 0};

QuadCorner corner(LatticePoint point, std::uint64_t id, std::initializer_list<Vec3> normals) {
  QuadCorner c{point, {id}, {}, NormalSense::outward};
  c.normals.fill(no_normal);
  std::transform(normals.begin(), normals.end(), c.normals.begin(), pack_normal);
  return c;
}

// The same whatever side the normals of some corners are on, where that says nothing.
void expect_senses_do_not_matter(const Quad& quad, bool cut) {
  for (unsigned corners = 0; corners < 16; ++corners) {
    Quad turned = quad;
    for (std::size_t k = 0; k < 4; ++k) {
      turned[k].sense = NormalSense::either;
      for (PackedNormal& n : turned[k].normals)
        if ((corners >> k & 1) != 0 && n != no_normal) n = pack_normal(unpack_normal(n) * -1.0);
    }
    EXPECT_EQ(cut_from_one(turned), cut) << corners;
  }
}

// The cut does not depend on the corner that comes first.
bool cut_of(Quad quad) {
  const bool cut = cut_from_one(quad);
  expect_senses_do_not_matter(quad, cut);
  std::rotate(quad.begin(), quad.begin() + 1, quad.end());
  EXPECT_NE(cut_from_one(quad), cut);
  return cut;
}

// Corners 0 and 2 on the edge of a box along x, 1 on its top and 3 on its front. Cutting from top
// to front makes the flatter pair of triangles, and bevels the edge.
TEST(QuadSplit, DoesNotBevelACrease) {
  const Quad quad{corner({0, 0, 0}, 1, {up, front}), corner({150, 0, -60}, 2, {front}),
                  corner({300, 0, 0}, 3, {front, up}), corner({150, 60, 0}, 4, {up})};
  EXPECT_FALSE(cut_of(quad));
}

// The same where all corners have three planes near, as at a box's corner.
TEST(QuadSplit, TakesTheNearestPlaneOfEachEnd) {
  const Quad quad{corner({0, 0, 0}, 1, {up, right, front}), corner({150, 0, -60}, 2, {front}),
                  corner({300, 0, 0}, 3, {right, front, up}), corner({150, 60, 0}, 4, {up})};
  EXPECT_FALSE(cut_of(quad));
}

// A ridge of a smooth surface runs from 1 to 3.
TEST(QuadSplit, FollowsASmoothRidge) {
  const double s = std::sqrt(0.5);
  const Quad quad{corner({100, 0, -100}, 1, {Vec3{s, 0, s}}), corner({0, 90, 0}, 2, {up}),
                  corner({-100, 0, -100}, 3, {Vec3{-s, 0, s}}), corner({0, -90, 0}, 4, {up})};
  EXPECT_TRUE(cut_of(quad));
}

// In a plane all heights are none: a quad that is not convex is cut from its reflex corner, or one
// of the triangles would face the other way.
TEST(QuadSplit, CutsFromAReflexCorner) {
  const Quad quad{corner({0, 0, 0}, 1, {up}), corner({100, -100, 0}, 2, {up}),
                  corner({20, 0, 0}, 3, {up}), corner({100, 100, 0}, 4, {up})};
  // Corner 2 is inside the triangle of the others.
  EXPECT_FALSE(cut_of(quad));
}

// Heights speak for the cut from 1 to 3, which would leave one triangle facing backwards.
TEST(QuadSplit, FacingAwayWeighsMoreThanHeight) {
  const double s = std::sqrt(0.5);
  const Vec3 tilted{0.6 * s, 0.8, 0.6 * s};
  const Quad quad{corner({0, 0, 0}, 1, {tilted}), corner({100, -100, 0}, 2, {up}),
                  corner({20, 0, 0}, 3, {tilted}), corner({100, 100, 0}, 4, {up})};
  EXPECT_FALSE(cut_of(quad));
}

// Around a lattice edge along z, corner 1 reflex; both cuts have triangles that face away from
// corner 3, and heights speak for the cut that turns one of its triangles over.
TEST(QuadSplit, WhereNormalsSayNothingNoTriangleTurnsOver) {
  const auto quad = [](CellKey last) {
    const auto id = [](CellKey leaf) { return VertexId::make(leaf, 0).bits; };
    return Quad{corner({95, 5, 0}, id({0, {3, 5, 0}}), {up}),
                corner({110, 90, 0}, id({0, {4, 5, 0}}), {up}),
                corner({195, 110, 0}, id({0, {4, 6, 0}}), {up}),
                corner({20, 180, 40}, id(last), {Vec3{0, 0, -1}})};
  };
  EXPECT_TRUE(cut_of(quad({0, {3, 6, 0}})));
  EXPECT_TRUE(cut_of(quad({1, {1, 3, 0}})));
  // Without an edge in common heights decide.
  EXPECT_FALSE(cut_from_one(quad({0, {3, 7, 0}})));
  EXPECT_FALSE(cut_from_one(quad({0, {3, 6, 1}})));
}

TEST(QuadSplit, AvoidsATriangleWithoutArea) {
  // Corner 1 lies on the line from 0 to 2.
  const Quad quad{corner({0, 0, 0}, 1, {up}), corner({50, 0, 0}, 2, {up}),
                  corner({100, 0, 0}, 3, {up}), corner({50, 500, 0}, 4, {up})};
  EXPECT_TRUE(cut_of(quad));
}

TEST(QuadSplit, TiesGoToTheShorterDiagonalThenToTheLowestId) {
  const auto rectangle = [](std::int32_t shear, std::uint64_t low) {
    return Quad{corner({0, 0, 0}, 7, {up}), corner({100, 0, 0}, low, {up}),
                corner({100 + shear, 100, 0}, 8, {up}), corner({shear, 100, 0}, 9, {up})};
  };
  EXPECT_TRUE(cut_of(rectangle(20, 10)));
  EXPECT_FALSE(cut_of(rectangle(-20, 10)));
  EXPECT_TRUE(cut_of(rectangle(0, 1)));
  EXPECT_FALSE(cut_of(rectangle(0, 10)));
}

// A step is as exact as positions are: the cut is then what it is without heights, by length.
TEST(QuadSplit, HeightsWithinAStepAreEqual) {
  const auto raised = [](std::int32_t z) {
    return Quad{corner({0, 0, 0}, 1, {up}), corner({120, 20, z}, 2, {}),
                corner({200, 200, 0}, 3, {up}), corner({20, 120, 0}, 4, {up})};
  };
  EXPECT_TRUE(cut_of(raised(0)));
  EXPECT_TRUE(cut_of(raised(1)));
  EXPECT_FALSE(cut_of(raised(2)));
}

}  // namespace
}  // namespace voxweld
