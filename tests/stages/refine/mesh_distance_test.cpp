// Distances between meshes against a look at all triangles.
#include "stages/refine/mesh_distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "plain_nearest.h"
#include "torus.h"

namespace voxweld {
namespace {

std::vector<LatticeTriangle> all_shapes(const RefineMesh& mesh) {
  std::vector<LatticeTriangle> shapes;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) shapes.push_back(mesh.shape(t));
  return shapes;
}

double plain_distance(const LatticePoint& point, const std::vector<LatticeTriangle>& shapes) {
  return std::sqrt(testing::nearest_triangle(point, shapes).squared);
}

LatticePoint moved(LatticePoint p, std::int32_t x) {
  p[0] += x;
  return p;
}

TEST(MeshDistance, IsThatOfTheNearestTriangleWhereItIsFar) {
  const RefineMesh mesh = testing::torus();
  const std::vector<LatticeTriangle> shapes = all_shapes(mesh);
  const MeshDistance distance(mesh);
  MeshDistance::Hint hint;  // of a point that lies anywhere
  std::mt19937 engine{5};
  const auto coordinate = [&] { return static_cast<std::int32_t>(engine() % 1000) - 100; };
  for (int i = 0; i < 300; ++i) {
    const LatticePoint point{coordinate(), coordinate(), coordinate()};
    const double plain = plain_distance(point, shapes);
    for (const double least : {0.0, 0.5, 40.0, 300.0}) {
      EXPECT_EQ(distance.beyond(point, least), std::max(least, plain)) << i << ' ' << least;
      EXPECT_EQ(std::sqrt(distance.squared_beyond(point, least * least, hint)),
                std::max(least, plain))
          << i << ' ' << least;
    }
  }
}

TEST(MeshDistance, OfNothingIsTheLeast) {
  const RefineMesh nothing;
  EXPECT_EQ(MeshDistance(nothing).beyond({1, 2, 3}, 7), 7);
  EXPECT_EQ(largest_distance(nothing, MeasuredPoints::all, MeshDistance(testing::torus()), 7), 7);
}

// One corner is moved off: then it is the farthest, and the middles of its edges are half as far.
TEST(MeshDistance, LooksAtCornersAndAtTheMiddlesOfEdges) {
  const RefineMesh mesh = testing::torus();
  const MeshDistance distance(mesh);
  EXPECT_LE(largest_distance(mesh, MeasuredPoints::all, distance, 0), std::sqrt(3.0));
  RefineMesh bent = mesh;
  // At the outer side of the ring, where +x leads away from it.
  std::size_t out = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    if (mesh.positions[v][0] > mesh.positions[out][0]) out = v;
  bent.positions[out] = moved(bent.positions[out], 100);
  const double corner = plain_distance(bent.positions[out], all_shapes(mesh));
  EXPECT_GT(corner, 90);
  EXPECT_EQ(largest_distance(bent, MeasuredPoints::all, distance, 0), corner);
  // The middle of one of its triangles or edges is as far from the mesh as nothing else of this.
  double most = 0;
  const std::vector<LatticeTriangle> bent_shapes = all_shapes(bent);
  for (const LatticePoint& p : mesh.positions)
    most = std::max(most, plain_distance(p, bent_shapes));
  EXPECT_GE(largest_distance(mesh, MeasuredPoints::all, MeshDistance(bent), 0), most);
}

TEST(MeshDistance, DoesNotDependOnTheOrderOfTriangles) {
  const RefineMesh mesh = testing::torus();
  RefineMesh bent = mesh;
  for (std::size_t v = 0; v < bent.positions.size(); v += 3)
    bent.positions[v] = moved(bent.positions[v], static_cast<std::int32_t>(v % 50));
  const auto both = [&](const RefineMesh& a, const RefineMesh& b) {
    return std::array{largest_distance(a, MeasuredPoints::all, MeshDistance(b), 1),
                      largest_distance(a, MeasuredPoints::long_edges, MeshDistance(b), 1)};
  };
  const auto before = both(bent, mesh);
  EXPECT_GT(before[0], 10);
  EXPECT_GT(before[1], 1);
  EXPECT_LE(before[1], before[0]);
  RefineMesh mixed = bent, other = mesh;
  std::shuffle(mixed.triangles.begin(), mixed.triangles.end(), std::mt19937(3));
  std::shuffle(other.triangles.begin(), other.triangles.end(), std::mt19937(4));
  EXPECT_EQ(both(mixed, other), before);
}

}  // namespace
}  // namespace voxweld
