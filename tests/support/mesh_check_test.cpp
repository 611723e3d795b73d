#include "tests/support/mesh_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace voxweld::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

const std::vector<Vec3> corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
const std::vector<Triangle> tetrahedron = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};

std::vector<Triangle> shifted(std::vector<Triangle> triangles, std::uint32_t by) {
  for (Triangle& t : triangles)
    for (std::uint32_t& v : t) v += by;
  return triangles;
}

std::vector<Triangle> both(std::vector<Triangle> a, const std::vector<Triangle>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

TEST(MeshCheck, TetrahedronIsSound) {
  const MeshSummary expected{.components = 1, .euler = 2};
  EXPECT_EQ(summarize(tetrahedron), expected);
  EXPECT_TRUE(summarize(tetrahedron).sound());
  EXPECT_DOUBLE_EQ(signed_volume(corners, tetrahedron), 1.0 / 6);
}

TEST(MeshCheck, FindsTheBoundary) {
  std::vector<Triangle> open = tetrahedron;
  open.pop_back();
  EXPECT_THAT(check_edges(open).boundary,
              ElementsAre(DirectedEdge{0, 2}, DirectedEdge{2, 3}, DirectedEdge{3, 0}));
  EXPECT_THAT(check_edges(open).duplicated, IsEmpty());
  EXPECT_THAT(nonmanifold_vertices(open), IsEmpty()) << "an open fan is manifold";
  EXPECT_EQ(euler_characteristic(open), 1);
  EXPECT_FALSE(summarize(open).sound());
}

TEST(MeshCheck, FindsATurnedTriangle) {
  std::vector<Triangle> turned = tetrahedron;
  std::swap(turned[3][1], turned[3][2]);
  EXPECT_THAT(check_edges(turned).duplicated,
              ElementsAre(DirectedEdge{0, 2}, DirectedEdge{2, 3}, DirectedEdge{3, 0}));
  EXPECT_THAT(check_edges(turned).boundary,
              ElementsAre(DirectedEdge{0, 2}, DirectedEdge{2, 3}, DirectedEdge{3, 0}));
}

TEST(MeshCheck, FindsTwoFansAtAVertex) {
  const auto apart = both(tetrahedron, shifted(tetrahedron, 4));
  EXPECT_EQ(connected_components(apart), 2u);
  EXPECT_TRUE(summarize(apart).sound());
  const auto touching = both(tetrahedron, shifted(tetrahedron, 3));
  EXPECT_TRUE(check_edges(touching).closed());
  EXPECT_THAT(nonmanifold_vertices(touching), ElementsAre(3));
  EXPECT_EQ(connected_components(touching), 1u);
}

TEST(MeshCheck, FindsAnEdgeOfFourTriangles) {
  auto second = shifted(tetrahedron, 4);
  for (Triangle& t : second)
    for (std::uint32_t& v : t)
      if (v < 6) v -= 4;  // shares vertices 0 and 1
  const auto mesh = both(tetrahedron, second);
  EXPECT_THAT(check_edges(mesh).duplicated, ElementsAre(DirectedEdge{0, 1}, DirectedEdge{1, 0}));
  EXPECT_THAT(nonmanifold_vertices(mesh), ElementsAre(0, 1));
}

TEST(MeshCheck, ReportsDegenerateTrianglesAndLeavesThemOut) {
  auto mesh = tetrahedron;
  mesh.push_back({1, 1, 2});
  EXPECT_THAT(degenerate_triangles(mesh), ElementsAre(4u));
  EXPECT_TRUE(check_edges(mesh).closed());
  EXPECT_EQ(euler_characteristic(mesh), 2);
}

TEST(MeshCheck, WeldsOnExactCoordinates) {
  std::vector<Vec3> soup;
  std::vector<Triangle> triangles;
  for (const Triangle& t : tetrahedron) {
    const auto first = static_cast<std::uint32_t>(soup.size());
    for (const std::uint32_t v : t) soup.push_back(corners[v]);
    triangles.push_back({first, first + 1, first + 2});
  }
  soup.back().x = -0.0;  // equal to 0
  EXPECT_EQ(connected_components(triangles), 4u);
  const WeldedMesh welded = weld(soup, triangles);
  EXPECT_EQ(welded.vertices.size(), 4u);
  EXPECT_TRUE(summarize(welded.triangles).sound());
  EXPECT_DOUBLE_EQ(signed_volume(welded.vertices, welded.triangles), 1.0 / 6);
}

// A sphere of four triangles, a torus of 18, and a disc.
TEST(MeshCheck, TellsTheEulerNumberOfEachComponent) {
  std::vector<Triangle> all = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}, {50, 51, 52}};
  for (std::uint32_t i = 0; i < 3; ++i)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto at = [](std::uint32_t a, std::uint32_t b) { return 10 + 3 * (a % 3) + b % 3; };
      all.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
      all.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
    }
  EXPECT_EQ(component_eulers(all), (std::vector<std::int64_t>{0, 1, 2}));
}

}  // namespace
}  // namespace voxweld::testing
