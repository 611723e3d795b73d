#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/support/mesh_points.h"
#include "tests/support/phantom_distance.h"
#include "tests/support/triangle_tree.h"

namespace voxweld::testing {
namespace {

constexpr double radius = 40.4;  // of the sphere of 101 samples, about (50, 50, 50)

// A ball whose vertices lie on that sphere.
TriangleMesh ball(int levels) {
  TriangleMesh mesh = dented_ball({}, 1, levels);
  for (Vec3& v : mesh.vertices) v = Vec3{50, 50, 50} + v * (radius / std::sqrt(dot(v, v)));
  return mesh;
}

TEST(SurfacePoints, LieOnThePhantom) {
  for (const auto kind : {PhantomKind::sphere, PhantomKind::part, PhantomKind::gyroid}) {
    const auto field = make_analytic_field(kind, 101);
    const auto points = surface_points(*field, 101, 2000);
    EXPECT_NEAR(static_cast<double>(points.size()), 2000, 400);
    for (const Vec3& p : points) EXPECT_LT(field->surface_distance(p), 1e-6);
  }
}

TEST(SurfacePoints, SpreadByAreaOnAllSides) {
  const auto field = make_analytic_field(PhantomKind::sphere, 101);
  const auto all = surface_points(*field, 101, 1000000000);
  // Lines along each axis see the sphere's shadow twice.
  const double expected = 6 * std::numbers::pi * radius * radius;
  EXPECT_NEAR(static_cast<double>(all.size()), expected, expected / 50);
  std::array<int, 8> octants{};
  for (const Vec3& p : all)
    ++octants[(p.x > 50 ? 1U : 0U) + (p.y > 50 ? 2U : 0U) + (p.z > 50 ? 4U : 0U)];
  for (const int count : octants) EXPECT_NEAR(count, expected / 8, expected / 160);
  // Between the samples, not at them.
  EXPECT_EQ(std::ranges::count_if(all, [](const Vec3& p) { return p.x == std::floor(p.x); }), 0);
}

TEST(SurfacePoints, SameWhateverTheThreads) {
  const auto field = make_analytic_field(PhantomKind::gyroid, 90);
  const auto many = surface_points(*field, 90, 3000);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(surface_points(*field, 90, 3000), many);
}

TEST(SurfacePoints, SeeAPieceThatIsMissing) {
  const auto field = make_analytic_field(PhantomKind::sphere, 101);
  TriangleMesh mesh = ball(5);
  std::erase_if(mesh.triangles, [&](const auto& t) { return mesh.vertices[t[0]].x > 50; });
  const TriangleTree tree(mesh);
  const auto to_mesh = [&](Vec3 p) { return tree.distance_to(p); };
  const DistanceStatistics there = measure_mesh(*field, mesh.vertices, mesh.triangles).triangles;
  const DistanceStatistics back = measure_points(to_mesh, surface_points(*field, 101, 5000));
  EXPECT_LT(there.max, 1);
  // The pole is as far from the rim of the half that is left as the chord of a quarter is long.
  EXPECT_NEAR(back.max, radius * std::numbers::sqrt2, 4);
  EXPECT_GT(back.mean, 10);
}

TEST(PointsByArea, FollowTheArea) {
  // One face of a unit square and one of nine, in two triangles each.
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0},
                   {5, 0, 0}, {8, 0, 0}, {5, 3, 0}, {8, 3, 0}};
  mesh.triangles = {{0, 1, 2}, {1, 3, 2}, {4, 5, 6}, {5, 7, 6}, {0, 0, 1}};
  const auto points = points_by_area(mesh, 1000);
  ASSERT_EQ(points.size(), 1000u);
  EXPECT_EQ(std::ranges::count_if(points, [](const Vec3& p) { return p.x <= 1; }), 100);
  const TriangleTree tree(mesh);
  for (const Vec3& p : points) EXPECT_LT(tree.distance_to(p), 1e-12);
  EXPECT_TRUE(points_by_area({{{0, 0, 0}}, {{0, 0, 0}}}, 10).empty());
}

}  // namespace
}  // namespace voxweld::testing
