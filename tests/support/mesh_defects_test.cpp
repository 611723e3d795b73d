#include "tests/support/mesh_defects.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/mesh_check.h"
#include "tests/support/triangle_meshes.h"

namespace voxweld::testing {
namespace {

const std::array<Vec3, 4> corners = {Vec3{0, 0, 0}, {8, 0, 0}, {0, 8, 0}, {0, 0, 8}};

std::array<std::uint64_t, 4> counts(const TriangleMesh& mesh) {
  const MeshDefects d = find_defects(mesh);
  return {d.boundary_edges, d.nonmanifold_edges, d.nonmanifold_vertices, d.degenerate};
}
using Counts = std::array<std::uint64_t, 4>;

TEST(MeshDefects, NoneOfTetrahedronAndBall) {
  EXPECT_EQ(counts(tetrahedron(corners)), (Counts{0, 0, 0, 0}));
  EXPECT_EQ(counts(dented_ball({5, 5, 5}, 3, 3)), (Counts{0, 0, 0, 0}));
}

TEST(MeshDefects, OpenTurnedAndThreefoldEdges) {
  TriangleMesh open = tetrahedron(corners);
  open.triangles.pop_back();
  EXPECT_EQ(counts(open), (Counts{3, 0, 0, 0})) << "open fans are manifold";
  TriangleMesh turned = tetrahedron(corners);
  std::swap(turned.triangles[3][1], turned.triangles[3][2]);
  EXPECT_EQ(counts(turned), (Counts{0, 3, 0, 0}));
  TriangleMesh fin = tetrahedron(corners);
  fin.vertices.push_back({-8, -8, 0});
  fin.triangles.push_back({0, 3, 4});
  EXPECT_EQ(counts(fin), (Counts{2, 1, 0, 0})) << "the vertices of a bad edge count with it";
}

TEST(MeshDefects, RingsThatTouchAtAVertex) {
  const auto far = tetrahedron({Vec3{0, 0, 0}, {-8, 0, 0}, {0, 0, -8}, {0, -8, 0}});
  const TriangleMesh apart = joined(tetrahedron(corners), far);
  EXPECT_EQ(counts(apart), (Counts{0, 0, 0, 0}));
  EXPECT_EQ(counts(welded(apart)), (Counts{0, 0, 1, 0}));
}

TEST(MeshDefects, WithoutArea) {
  TriangleMesh mesh = tetrahedron(corners);
  mesh.vertices.push_back({4, 0, 0});
  mesh.triangles.push_back({0, 4, 1});
  mesh.triangles.push_back({2, 2, 1});
  EXPECT_EQ(counts(mesh)[3], 2u);
  EXPECT_EQ(counts(mesh)[0], 2u) << "of the line's edges; two equal corners have none";
}

TEST(MeshDefects, WeldsByPlaceAndKeepsTriangles) {
  TriangleMesh soup;
  for (const auto& t : tetrahedron(corners).triangles) {
    const auto n = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t v : t) soup.vertices.push_back(corners[v]);
    soup.triangles.push_back({n, n + 1, n + 2});
  }
  EXPECT_EQ(counts(soup)[0], 12u);
  const TriangleMesh mesh = welded(soup);
  EXPECT_EQ(mesh.vertices.size(), 4u);
  EXPECT_EQ(counts(mesh), (Counts{0, 0, 0, 0}));
}

// Of closed meshes with holes, doubles and pinches made at random.
TEST(MeshDefects, AsThePlainChecks) {
  std::mt19937 random(1);
  for (int round = 0; round < 50; ++round) {
    TriangleMesh mesh = dented_ball({5, 5, 5}, 3, 2);
    std::uniform_int_distribution<std::uint32_t> vertex(
        0, static_cast<std::uint32_t>(mesh.vertices.size() - 1));
    for (int i = 0; i < round % 5; ++i)
      mesh.triangles.erase(mesh.triangles.begin() + std::ptrdiff_t{7} * i);
    const std::uint32_t from = vertex(random), to = vertex(random);
    for (auto& t : mesh.triangles)
      for (auto& v : t)
        if (v == from) v = to;
    const MeshDefects found = find_defects(mesh);
    const EdgeReport edges = check_edges(mesh.triangles);
    if (edges.duplicated.empty()) {
      EXPECT_EQ(found.boundary_edges, edges.boundary.size());
      EXPECT_EQ(found.nonmanifold_edges, 0u);
      EXPECT_EQ(found.nonmanifold_vertices, nonmanifold_vertices(mesh.triangles).size());
    } else {
      EXPECT_GT(found.nonmanifold_edges, 0u);
    }
  }
}

TEST(MeshDefects, PairsThatCut) {
  const std::vector<LatticePoint> places = {{0, 0, 0}, {8, 0, 0},  {0, 8, 0},  {2, 2, -4},
                                            {2, 2, 4}, {3, 2, -4}, {20, 0, 0}, {24, 0, 0}};
  const std::vector<std::array<std::uint32_t, 3>> triangles = {{0, 1, 2}, {3, 4, 5}, {0, 6, 7}};
  const ExactDefects found = find_exact_defects(places, triangles);
  EXPECT_EQ(found.intersecting_pairs, 1u);
  EXPECT_EQ(found.degenerate, 1u);
}

}  // namespace
}  // namespace voxweld::testing
