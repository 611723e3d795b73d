#include "tests/support/phantom_distance.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

namespace voxweld {
namespace {

// 0.4 * 101 - 40.4 = 0: unit cubes' worth of arithmetic about (50, 50, 50).
constexpr double radius = 40.4;

TEST(MeasureMesh, ByHand) {
  const auto sphere = make_analytic_field(PhantomKind::sphere, 101);
  const std::vector<Vec3> vertices = {
      {50 + radius, 50, 50}, {50, 50 + radius + 1, 50}, {50, 50, 50 - radius + 3}};
  const MeshDistances none = measure_mesh(*sphere, std::span<const Vec3>(vertices), {});
  EXPECT_EQ(none.vertices.count, 3u);
  EXPECT_NEAR(none.vertices.max, 3, 1e-12);
  EXPECT_NEAR(none.vertices.mean, 4.0 / 3, 1e-12);
  EXPECT_NEAR(none.vertices.p99, 3, 1e-12);
  EXPECT_EQ(none.triangles.count, 0u);
  EXPECT_EQ(none.triangles.max, 0);
}

TEST(MeasureMesh, TrianglesAreSampledInside) {
  const auto sphere = make_analytic_field(PhantomKind::sphere, 101);
  // Corners on the sphere; points inside the triangle lie up to its depth below.
  const std::vector<Vec3> vertices = {
      {50 + radius, 50, 50}, {50, 50 + radius, 50}, {50, 50, 50 + radius}};
  const std::vector<TriangleCorners> triangles = {{0, 1, 2}};
  const MeshDistances result = measure_mesh(*sphere, std::span<const Vec3>(vertices), triangles);
  EXPECT_EQ(result.triangles.count, 10u);
  EXPECT_NEAR(result.vertices.max, 0, 1e-12);
  EXPECT_NEAR(result.triangles.max, radius * (1 - 1 / std::sqrt(3.0)), 1e-9) << "its centre";
  // The three points nearest the corners: barycentric (10, 1, 1) / 12.
  EXPECT_GT(result.triangles.mean, radius * (1 - std::sqrt(102.0) / 12));
}

TEST(MeasureMesh, ByArea) {
  const auto sphere = make_analytic_field(PhantomKind::sphere, 101);
  // Around a point on the sphere and around its centre, so small that all points are as far; the
  // second is nine times as large. The third has no area.
  std::vector<Vec3> vertices;
  for (const auto& [x, size] : {std::pair{50 + radius, 1e-6}, {50.0, 3e-6}})
    for (const Vec3 off : {Vec3{0, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
      vertices.push_back(Vec3{x, 50, 50} + off * size * 1e3);
  vertices.push_back({50, 80, 50});
  const std::vector<TriangleCorners> triangles = {{0, 1, 2}, {3, 4, 5}, {6, 6, 6}};
  const MeshDistances result = measure_mesh(*sphere, std::span<const Vec3>(vertices), triangles);
  EXPECT_NEAR(result.triangles.mean, (0 + radius + radius - 30) / 3, 0.01);
  EXPECT_NEAR(result.by_area.mean, radius * 0.9, 0.01);
  EXPECT_NEAR(result.by_area.p99, radius, 0.1);
}

TEST(MeasureMesh, PercentileAndThreads) {
  const auto sphere = make_analytic_field(PhantomKind::sphere, 101);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> coordinate(0, 100);
  std::vector<Vec3> vertices;
  std::vector<TriangleCorners> triangles;
  std::vector<double> distances;
  for (std::uint32_t i = 0; i < 20000; ++i) {
    vertices.push_back({coordinate(random), coordinate(random), coordinate(random)});
    triangles.push_back({i, (i + 1) % 20000, (i + 7) % 20000});
    distances.push_back(sphere->surface_distance(vertices.back()));
  }
  const MeshDistances many = measure_mesh(*sphere, std::span<const Vec3>(vertices), triangles);
  std::sort(distances.begin(), distances.end());
  EXPECT_GE(many.vertices.p99, distances[19799]);
  EXPECT_LE(many.vertices.p99, distances[19799] * 1.001);
  EXPECT_GE(many.vertices.p999, distances[19979]);
  EXPECT_LE(many.vertices.p999, distances[19979] * 1.001);
  EXPECT_EQ(many.vertices.max, distances.back());
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  const MeshDistances one = measure_mesh(*sphere, std::span<const Vec3>(vertices), triangles);
  EXPECT_EQ(one.vertices.mean, many.vertices.mean);
  EXPECT_EQ(one.triangles.mean, many.triangles.mean);
  EXPECT_EQ(one.triangles.max, many.triangles.max);
  EXPECT_EQ(one.triangles.p99, many.triangles.p99);
  EXPECT_EQ(one.by_area.mean, many.by_area.mean);
  EXPECT_EQ(one.by_area.p99, many.by_area.p99);
  EXPECT_EQ(one.by_area.p999, many.by_area.p999);
}

}  // namespace
}  // namespace voxweld
