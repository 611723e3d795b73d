// The yardsticks of tests/paper, on shapes of known size.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "stages/solids/mesh_boundary.h"
#include "tests/paper/extrusion.h"
#include "tests/paper/surface_net.h"
#include "tests/paper/true_surface.h"
#include "tests/support/mesh_check.h"
#include "tests/support/triangle_meshes.h"

namespace voxweld::paper {
namespace {

const Outline ring = {{{-4, -3}, {4, -3}, {4, 3}, {-4, 3}}, {{-2, -1}, {-2, 1}, {2, 1}, {2, -1}}};

TEST(Extrusion, OfAnOutlineWithAHoleIsClosed) {
  const Frame3 frame{{1, 2, 3}, {Vec3{0, 1, 0}, Vec3{0, 0, 1}, Vec3{1, 0, 0}}};
  const TriangleMesh mesh = extrude(ring, -1, 1.5, frame);
  EXPECT_TRUE(boundary_of(mesh).closed());
  EXPECT_NEAR(testing::volume_of(mesh), (48 - 8) * 2.5, 1e-9);
  EXPECT_TRUE(holds(ring, {3, 0}));
  EXPECT_FALSE(holds(ring, {1, 0.5}));
  EXPECT_FALSE(holds(ring, {5, 0}));
}

TEST(Extrusion, FacesOutwardWhicheverWayTheOutlineWinds) {
  Outline reversed = ring;
  for (Contour& contour : reversed) std::reverse(contour.begin(), contour.end());
  EXPECT_NEAR(testing::volume_of(extrude(reversed, 0, 1, {})), 40, 1e-9);
}

SurfaceNet net_of_ball(double radius) {
  return SurfaceNet({16, 16, 16}, [=](Index3 s) {
    const Vec3 d{double(s.x) - 7.4, double(s.y) - 7.7, double(s.z) - 7.5};
    return dot(d, d) <= radius * radius;
  });
}

TEST(SurfaceNet, OfOneSampleIsACube) {
  const SurfaceNet net({3, 3, 3}, [](Index3 s) { return s == Index3{1, 1, 1}; });
  const TriangleMesh mesh = net.mesh();
  EXPECT_EQ(mesh.vertices.size(), 8u);
  EXPECT_EQ(mesh.triangles.size(), 12u);
  EXPECT_NEAR(testing::volume_of(mesh), 1, 1e-12);
}

TEST(SurfaceNet, StaysClosedAndInItsBoxesWhereItIsRelaxed) {
  SurfaceNet net = net_of_ball(5);
  const TriangleMesh before = net.mesh();
  EXPECT_TRUE(testing::check_edges(before.triangles).closed());
  net.relax({200, 0.5, 0.5});
  const TriangleMesh after = net.mesh();
  EXPECT_TRUE(testing::check_edges(after.triangles).closed());
  double furthest = 0;
  for (std::size_t v = 0; v < before.vertices.size(); ++v)
    for (int a = 0; a < 3; ++a)
      furthest = std::max(furthest, std::abs(after.vertices[v][a] - before.vertices[v][a]));
  EXPECT_NEAR(furthest, 0.5, 1e-9);  // some would go on
}

// Gibson's own result: smoother, and shrunk.
TEST(SurfaceNet, RelaxingMendsNormalsAndShrinks) {
  Solid ball;
  ball.center = {7.4, 7.7, 7.5};
  ball.radius = 5;
  SurfaceNet net = net_of_ball(5);
  const SurfaceErrors before = surface_errors(ball, net.mesh());
  net.relax({});
  const SurfaceErrors after = surface_errors(ball, net.mesh());
  EXPECT_GT(before.mean_degrees, 30);
  EXPECT_LT(after.mean_degrees, before.mean_degrees / 2);
  EXPECT_LT(after.volume, before.volume - 0.05);
}

TEST(TrueSurface, OfABoxMeshMovedOutward) {
  Solid box;
  box.shape = SolidShape::box;
  box.size = {10, 8, 6};
  const SurfaceErrors exact = surface_errors(box, testing::box_mesh({-5, -4, -3}, {5, 4, 3}));
  EXPECT_NEAR(exact.max, 0, 1e-12);
  EXPECT_NEAR(exact.max_degrees, 0, 1e-5);
  EXPECT_NEAR(exact.volume, 0, 1e-12);
  const SurfaceErrors larger =
      surface_errors(box, testing::box_mesh({-5.5, -4.5, -3.5}, {5.5, 4.5, 3.5}));
  EXPECT_NEAR(larger.mean, 0.5, 0.02);
  EXPECT_NEAR(larger.volume, 11.0 * 9 * 7 / (10 * 8 * 6) - 1, 1e-12);
}

TEST(TrueSurface, DistancesAndNormalsOfRoundSolids) {
  Solid torus;
  torus.shape = SolidShape::torus;
  torus.center = {1, 0, 0};
  torus.radius = 5;
  torus.tube = 2;
  EXPECT_NEAR(distance_to_surface(torus, {6, 0, 2.5}), 0.5, 1e-12);
  EXPECT_NEAR(distance_to_surface(torus, {9, 0, 0}), 1, 1e-12);
  EXPECT_NEAR(degrees_off(torus, {6, 0, 2}, {0, 0, 1}, 0.75), 0, 1e-5);
  EXPECT_NEAR(degrees_off(torus, {6, 0, 2}, {1, 0, 0}, 0.75), 90, 1e-9);
  EXPECT_NEAR(volume_of_solid(torus), 2 * std::numbers::pi * std::numbers::pi * 20, 1e-9);
}

}  // namespace
}  // namespace voxweld::paper
