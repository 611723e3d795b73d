#include "stages/encode/adjacency.h"

#include <gtest/gtest.h>

#include "tests/support/shapes.h"

namespace voxweld {
namespace {

std::vector<Fan> fans_of(const std::vector<Triangle>& triangles, std::size_t vertices,
                         std::uint32_t v) {
  std::vector<Fan> fans;
  Adjacency(std::span<const Triangle>(triangles), vertices).fans(v, fans);
  return fans;
}

TEST(Adjacency, ClosedMeshHasOneClosedFanAVertex) {
  const TileMesh mesh = testing::make_torus({}, testing::small_lattice());
  const Adjacency adjacency(std::span<const Triangle>(mesh.triangles), mesh.positions.size());
  std::vector<Fan> fans;
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    adjacency.fans(v, fans);
    ASSERT_EQ(fans.size(), 1u);
    EXPECT_TRUE(fans[0].closed);
    EXPECT_EQ(fans[0].half_edges.size(), adjacency.outgoing(v).size());
  }
  for (std::uint32_t h = 0; h < 3 * mesh.triangles.size(); ++h) {
    const std::uint32_t o = adjacency.opposite(h);
    ASSERT_LT(o, 3 * mesh.triangles.size());
    EXPECT_EQ(adjacency.from(o), adjacency.to(h));
    EXPECT_EQ(adjacency.opposite(o), h);
  }
}

TEST(Adjacency, OpenFansRunCounterClockwise) {
  //  3 - 2
  //  | / |   seen from outside, counter-clockwise
  //  0 - 1
  const auto fans = fans_of({{0, 1, 2}, {0, 2, 3}}, 4, 0);
  ASSERT_EQ(fans.size(), 1u);
  EXPECT_FALSE(fans[0].closed);
  EXPECT_EQ(fans[0].from, 1u);
  EXPECT_EQ(fans[0].to, 3u);
  EXPECT_EQ(fans[0].half_edges.size(), 2u);
}

TEST(Adjacency, ComplexAndDegenerateEdgesEndFans) {
  const std::vector<Triangle> book = {{0, 1, 2}, {1, 0, 3}, {1, 0, 4}};
  const Adjacency adjacency(std::span<const Triangle>(book), 5);
  EXPECT_EQ(adjacency.opposite(0), Adjacency::complex);
  EXPECT_EQ(adjacency.opposite(3), Adjacency::complex);
  EXPECT_EQ(fans_of(book, 5, 0).size(), 3u);
  EXPECT_FALSE(fans_of({{0, 0, 1}}, 2, 0).empty());  // no endless walk
}

TEST(Adjacency, SplitFansCopiesAVertexOnceForEachFan) {
  TileMesh mesh;
  mesh.positions = {{0, 0, 0},   {1, 0, 0}, {1, 1, 0}, {-1, 0, 0},
                    {-1, -1, 0}, {0, 5, 0}, {-1, 5, 0}};
  mesh.ids = {{0}, {4}, {8}, {12}, {16}, {20}, {24}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 4}, {0, 5, 6}};
  EXPECT_EQ(split_fans(mesh), 2u);
  EXPECT_EQ(mesh.positions.size(), 9u);
  EXPECT_EQ(mesh.positions[7], mesh.positions[0]);
  EXPECT_EQ(mesh.ids[8], mesh.ids[0]);
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {7, 3, 4}, {8, 5, 6}}));
  EXPECT_EQ(split_fans(mesh), 0u);
}

}  // namespace
}  // namespace voxweld
