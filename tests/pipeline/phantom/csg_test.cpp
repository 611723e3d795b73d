#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "pipeline/phantom/csg_field.h"
#include "pipeline/phantom/csg_model.h"
#include "pipeline/phantom/csg_surface.h"

namespace voxweld {
namespace {

constexpr auto unite = CsgPrimitive::Op::unite;
constexpr auto subtract = CsgPrimitive::Op::subtract;

Rows identity() {
  return {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
}

TEST(CsgPrimitives, DistancesByHand) {
  const CsgPrimitive box{unite, CsgShape::box, {1, 2, 3}, {4, 5, 6}};
  EXPECT_DOUBLE_EQ(signed_distance(box, {1, 2, 3}), -4);
  EXPECT_DOUBLE_EQ(signed_distance(box, {8, 11, 3}), 5);
  EXPECT_DOUBLE_EQ(signed_distance(box, {1, 2, 10}), 1);
  const CsgPrimitive z{unite, CsgShape::cylinder_z, {0, 0, 0}, {10, 10, 20}};
  EXPECT_DOUBLE_EQ(signed_distance(z, {0, 0, 0}), -10);
  EXPECT_DOUBLE_EQ(signed_distance(z, {9, 12, 0}), 5);
  EXPECT_DOUBLE_EQ(signed_distance(z, {0, 13, 24}), 5);
  const CsgPrimitive x{unite, CsgShape::cylinder_x, {0, 0, 0}, {20, 10, 10}};
  EXPECT_DOUBLE_EQ(signed_distance(x, {24, 0, 13}), 5);
  const CsgPrimitive gable{unite, CsgShape::gable, {0, 0, 0}, {50, 3, 2}};  // slopes 3 : 4
  EXPECT_DOUBLE_EQ(signed_distance(gable, {0, 0, -2.5}), 0.5);
  EXPECT_DOUBLE_EQ(signed_distance(gable, {0, 0, 3}), 1) << "above the ridge";
  EXPECT_DOUBLE_EQ(signed_distance(gable, {0, 1.5 + 0.8, 0.6}), 1) << "beside a slope";
  EXPECT_NEAR(signed_distance(gable, {0, 1.5 - 0.08, -0.06}), -0.1, 1e-12);
  EXPECT_DOUBLE_EQ(signed_distance(gable, {51, 0, -1}), 1);
}

TEST(CsgPrimitives, ChangeByAtMostTheWayWalked) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-200, 200);
  const CsgModel part = part_model(), temple = temple_model();
  for (const CsgModel* model : {&part, &temple})
    for (const CsgPrimitive& primitive : model->primitives)
      for (int i = 0; i < 200; ++i) {
        const Vec3 a{place(random), place(random), place(random)};
        const Vec3 b = a + Vec3{place(random), place(random), place(random)} * 0.05;
        const Vec3 step = b - a;
        EXPECT_LE(std::abs(signed_distance(primitive, a) - signed_distance(primitive, b)),
                  std::sqrt(dot(step, step)) * (1 + 1e-12) + 1e-9);
      }
}

// Sawn corner: the nearest point may lie on a face, on the edge two primitives make, or in the
// corner three make, where the running maximum falls short of the distance.
TEST(CsgSurface, DistanceAtEdgesByHand) {
  const CsgSurface surface({identity(),
                            {{unite, CsgShape::box, {0, 0, 0}, {100, 100, 100}},
                             {subtract, CsgShape::box, {100, 100, 0}, {100, 100, 200}}}});
  EXPECT_NEAR(surface.distance({-50, -50, 0}), 50, 1e-6);
  EXPECT_NEAR(surface.distance({20, 30, 0}), 20, 1e-6) << "in the notch, beside the wall x = 0";
  EXPECT_NEAR(surface.distance({-3, -4, 0}), 5, 1e-6) << "inside, nearest to the notch's edge";
  EXPECT_NEAR(surface.distance({3, 108, 50}), std::hypot(3, 8), 1e-6) << "past the wall's end";
  EXPECT_LT(std::abs(surface.value({3, 108, 50})), 8.001);
  EXPECT_NEAR(surface.distance({3, 104, 112}), std::sqrt(9 + 16 + 144.0), 1e-6) << "three planes";
}

TEST(CsgSurface, DistanceAtACurvedEdgeByHand) {
  // A bore of radius 10 through a plate: the rim is the circle of radius 10 at z = 5.
  const CsgSurface surface({identity(),
                            {{unite, CsgShape::box, {0, 0, 0}, {50, 50, 5}},
                             {subtract, CsgShape::cylinder_z, {0, 0, 0}, {10, 10, 99}}}});
  EXPECT_NEAR(surface.distance({6, 0, 8}), 5, 1e-6);
  EXPECT_NEAR(surface.distance({0, -7, 9}), 5, 1e-6);
  EXPECT_NEAR(surface.distance({14, 0, 8}), 3, 1e-6);
}

// Against the points of a fine lattice projected onto the surface: the distance is never larger
// than to any of them, never smaller than the running value, and points 1 away are found.
TEST(CsgSurface, DistanceAgreesWithSampling) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> coordinate(-0.7, 0.7);
  const CsgSurface surfaces[] = {CsgSurface(part_model()), CsgSurface(temple_model())};
  for (const CsgSurface& surface : surfaces) {
    int tried = 0, exceeds = 0;
    std::uniform_real_distribution<double> place(-170, 170);
    while (tried < 1000) {
      const Vec3 q{place(random), place(random), place(random)};
      if (std::abs(surface.value(q)) > 1.5) continue;
      ++tried;
      const double distance = surface.distance(q);
      ASSERT_GE(distance, std::abs(surface.value(q)) - 1e-6);
      exceeds += distance > std::abs(surface.value(q)) + 1e-6;
      // Within less than the distance the sign must not change.
      for (int i = 0; i < 300; ++i) {
        Vec3 step{coordinate(random), coordinate(random), coordinate(random)};
        step = step * (distance * 0.999 / std::sqrt(dot(step, step)));
        ASSERT_GT(surface.value(q + step) * surface.value(q), 0);
      }
      // Just beyond it, it must somewhere.
      bool found = false;
      for (int i = 0; i < 60000 && !found; ++i) {
        Vec3 step{coordinate(random), coordinate(random), coordinate(random)};
        step = step * ((distance * 1.03 + 0.03) / std::sqrt(dot(step, step)));
        found = surface.value(q + step) * surface.value(q) <= 0;
      }
      ASSERT_TRUE(found) << q.x << ' ' << q.y << ' ' << q.z << ": " << distance;
    }
    EXPECT_GT(exceeds, 0) << "some points must have tested the edges";
  }
}

// Leaving out what cannot matter and saturating far blocks never changes what a file holds.
TEST(CsgField, CullingKeepsEveryBitWithinTheLimit) {
  const std::int64_t n = 64;
  for (const CsgModel& model : {part_model(), temple_model()}) {
    const CsgField field(model, n);
    std::vector<double> values(16 * 8 * 8);
    for (std::int64_t z = 0; z < n; z += 8)
      for (std::int64_t y = 0; y < n; y += 8)
        for (std::int64_t x = 0; x < n; x += 16) {
          for (const double limit : {2.0, std::numeric_limits<double>::infinity()}) {
            field.fill({{x, y, z}, {x + 16, y + 8, z + 8}}, limit, values.data());
            for (std::int64_t i = 0; i < 16 * 8 * 8; ++i) {
              const double exact =
                  field.at({static_cast<double>(x + i % 16), static_cast<double>(y + i / 16 % 8),
                            static_cast<double>(z + i / 128)});
              const double got = values[static_cast<std::size_t>(i)];
              if (std::abs(exact) <= limit)
                ASSERT_EQ(got, exact);
              else
                ASSERT_TRUE(std::abs(got) > limit && (got > 0) == (exact > 0));
            }
          }
        }
  }
}

}  // namespace
}  // namespace voxweld
