#include "tests/support/triangle_tree.h"

#include <gtest/gtest.h>

#include <random>

namespace voxweld::testing {
namespace {

double nearest(const TriangleMesh& mesh, Vec3 p) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& t : mesh.triangles)
    least =
        std::min(least, distance(p, mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]));
  return least;
}

TEST(TriangleTree, AsAllTrianglesOneByOne) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> coordinate(-10, 30);
  for (const int levels : {0, 1, 3}) {
    const TriangleMesh mesh = dented_ball({10, 11, 12}, 7, levels);
    const TriangleTree tree(mesh);
    for (int i = 0; i < 300; ++i) {
      const Vec3 p{coordinate(random), coordinate(random), coordinate(random)};
      EXPECT_NEAR(tree.distance_to(p), nearest(mesh, p), 1e-12);
    }
    for (const Vec3& v : mesh.vertices) EXPECT_NEAR(tree.distance_to(v), 0, 1e-12);
  }
}

TEST(TriangleTree, ByHand) {
  const TriangleMesh mesh = box_mesh({0, 0, 0}, {2, 4, 6});
  const TriangleTree tree(mesh);
  EXPECT_DOUBLE_EQ(tree.distance_to({1, 2, 3}), 1) << "from within";
  EXPECT_DOUBLE_EQ(tree.distance_to({1, 1, 9}), 3);
  EXPECT_DOUBLE_EQ(tree.distance_to({-3, -4, 1}), 5) << "to an edge";
  EXPECT_DOUBLE_EQ(tree.distance_to({1002, 4, 6}), 1000) << "to a corner, far away";
}

TEST(TriangleTree, OddMeshes) {
  const TriangleMesh none;
  EXPECT_EQ(TriangleTree(none).distance_to({1, 2, 3}), std::numeric_limits<double>::infinity());
  const TriangleMesh point{{{1, 1, 1}}, {{0, 0, 0}}};
  EXPECT_DOUBLE_EQ(TriangleTree(point).distance_to({1, 4, 5}), 5);
  const TriangleMesh edge{{{0, 0, 0}, {8, 0, 0}}, {{0, 1, 1}}};
  EXPECT_DOUBLE_EQ(TriangleTree(edge).distance_to({4, 3, 4}), 5);
}

}  // namespace
}  // namespace voxweld::testing
