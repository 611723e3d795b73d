#include "stages/solids/mesh_boundary.h"

#include <gtest/gtest.h>

#include "tests/support/triangle_meshes.h"

namespace voxweld {
namespace {

using testing::box_mesh;

TEST(MeshBoundary, ClosedMeshesHaveNone) {
  for (const TriangleMesh& mesh :
       {box_mesh({0, 0, 0}, {1, 2, 3}), testing::dented_ball({}, 3, 4), TriangleMesh{}}) {
    const MeshBoundary boundary = boundary_of(mesh);
    EXPECT_TRUE(boundary.closed());
    EXPECT_TRUE(boundary.holes.empty());
  }
}

// Two boxes that share an edge: four triangles on it. One box twice: two on each side of each edge.
TEST(MeshBoundary, EvenUseIsNoBoundary) {
  TriangleMesh mesh = box_mesh({0, 0, 0}, {1, 1, 1});
  const auto first = mesh.triangles;
  mesh.triangles.insert(mesh.triangles.end(), first.begin(), first.end());
  EXPECT_TRUE(boundary_of(mesh).closed());
  mesh.triangles = first;
  // The second box's corners 0 and 4 are the first's 3 and 7.
  const TriangleMesh other = box_mesh({1, 1, 0}, {2, 2, 1});
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (auto t : other.triangles) {
    for (std::uint32_t& corner : t) corner = corner == 0 ? 3 : corner == 4 ? 7 : corner + 8;
    mesh.triangles.push_back(t);
  }
  EXPECT_TRUE(boundary_of(mesh).closed());
}

TEST(MeshBoundary, TellsHolesTheLargestFirst) {
  TriangleMesh mesh = testing::subdivided(box_mesh({0, 0, 0}, {4, 4, 4}));
  // All of the face x = 0, and one triangle of the face x = 4.
  bool one = false;
  std::erase_if(mesh.triangles, [&](const auto& t) {
    const auto on = [&](double x) {
      return mesh.vertices[t[0]].x == x && mesh.vertices[t[1]].x == x && mesh.vertices[t[2]].x == x;
    };
    return on(0) || (on(4) && !std::exchange(one, true));
  });
  const MeshBoundary boundary = boundary_of(mesh);
  EXPECT_EQ(boundary.edges, 11U);
  ASSERT_EQ(boundary.holes.size(), 2U);
  EXPECT_EQ(boundary.holes[0].edges, 8U);
  EXPECT_EQ(boundary.holes[0].center, (Vec3{0, 2, 2}));
  EXPECT_DOUBLE_EQ(boundary.holes[0].size, std::sqrt(32));
  EXPECT_EQ(boundary.holes[1].edges, 3U);
  EXPECT_EQ(boundary.holes[1].center.x, 4);
}

TEST(MeshBoundary, BoundsAreOfTriangles) {
  TriangleMesh box = box_mesh({-1, 2, 3}, {4, 5, 6});
  box.vertices.push_back({100, 0, 0});
  EXPECT_EQ(bounds_of(box).lo, (Vec3{-1, 2, 3}));
  EXPECT_EQ(bounds_of(box).hi, (Vec3{4, 5, 6}));
}

TEST(MeshBoundary, SignedVolume) {
  TriangleMesh box = box_mesh({1e6, 1e6, 1e6}, {1e6 + 1, 1e6 + 2, 1e6 + 3});
  EXPECT_NEAR(signed_volume(box), 6, 1e-9);
  for (auto& t : box.triangles) std::swap(t[1], t[2]);
  EXPECT_NEAR(signed_volume(box), -6, 1e-9);
  EXPECT_EQ(signed_volume({}), 0);
}

}  // namespace
}  // namespace voxweld
