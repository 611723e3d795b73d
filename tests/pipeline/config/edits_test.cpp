#include "pipeline/config/edits.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <bit>
#include <cmath>

#include "pipeline/config/edit_settings.h"

namespace voxweld {
namespace {

using Axes = std::array<Vec3, 3>;

Solid solid_of(const EditConfig& edit) {
  Config config;
  config.edits = {edit};
  return edits_of(config).at(0).solid;
}

Axes along(Vec3 axis) {
  return solid_of({.shape = SolidShape::cylinder, .axis = axis}).axes;
}

Axes turned(Vec3 degrees) {
  return solid_of({.shape = SolidShape::box, .rotate = degrees}).axes;
}

constexpr Axes frame = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};

TEST(Edits, KeepOrderAndNumbers) {
  Config config;
  EXPECT_TRUE(edits_of(config).empty());
  config.edits = {{.op = EditOp::subtract,
                   .shape = SolidShape::torus,
                   .center = {1, 2, 3},
                   .radius = 4,
                   .tube = 1},
                  {.op = EditOp::intersect, .shape = SolidShape::box, .size = {4, 5, 6}}};
  Edits expected(2);
  expected[0].op = EditOp::subtract;
  Solid& torus = expected[0].solid;
  torus.shape = SolidShape::torus;
  torus.center = {1, 2, 3};
  torus.radius = 4;
  torus.tube = 1;
  expected[1].op = EditOp::intersect;
  expected[1].solid.shape = SolidShape::box;
  expected[1].solid.size = {4, 5, 6};
  EXPECT_EQ(edits_of(config), expected);
}

TEST(Edits, OnlyThoseThatGiveAMaterialHaveIt) {
  const auto material_of = [](EditOp op) {
    Config config;
    config.edits = {{.op = op, .material = 7}};
    return edits_of(config).at(0).material;
  };
  EXPECT_EQ(material_of(EditOp::add), 7U);
  EXPECT_EQ(material_of(EditOp::replace), 7U);
  EXPECT_EQ(material_of(EditOp::subtract), exterior);
  EXPECT_EQ(material_of(EditOp::intersect), exterior);
}

TEST(Edits, DefaultsAreTheFrame) {
  for (const SolidShape shape : all_shapes) EXPECT_EQ(solid_of({.shape = shape}).axes, frame);
}

TEST(Edits, TheHeightIsAlongTheAxis) {
  EXPECT_EQ(along({0, 0, 25})[2], (Vec3{0, 0, 1}));
  EXPECT_EQ(along({0, -3, 0})[2], (Vec3{0, -1, 0}));
  EXPECT_EQ(along({3, 0, 4})[2], (Vec3{0.6, 0, 0.8}));
  EXPECT_EQ(along({0, 0, 5e-324})[2], (Vec3{0, 0, 1}));
  EXPECT_EQ(along({1e308, 1e308, 0}), along({1, 1, 0}));
}

TEST(Edits, QuarterTurnsAreExact) {
  EXPECT_EQ(turned({0, 0, 0}), frame);
  EXPECT_EQ(turned({360, -720, 3600}), frame);
  EXPECT_EQ(turned({90, 0, 0}), (Axes{Vec3{1, 0, 0}, Vec3{0, 0, 1}, Vec3{0, -1, 0}}));
  EXPECT_EQ(turned({0, 90, 0}), (Axes{Vec3{0, 0, -1}, Vec3{0, 1, 0}, Vec3{1, 0, 0}}));
  EXPECT_EQ(turned({0, 0, 90}), (Axes{Vec3{0, 1, 0}, Vec3{-1, 0, 0}, Vec3{0, 0, 1}}));
  // About x first: its y comes to z, which the turn about y then brings to x.
  EXPECT_EQ(turned({90, 90, 0}), (Axes{Vec3{0, 0, -1}, Vec3{1, 0, 0}, Vec3{0, -1, 0}}));
  // No -0: equal edits have equal bits.
  for (const Vec3& axis : turned({90, 180, 270}))
    for (int i = 0; i < 3; ++i) EXPECT_FALSE(axis[i] == 0 && std::signbit(axis[i]));
}

TEST(Edits, TurnsAreRightHanded) {
  const Axes axes = turned({0, 0, 30});
  EXPECT_NEAR(axes[0].x, std::sqrt(3) / 2, 1e-15);
  EXPECT_NEAR(axes[0].y, 0.5, 1e-15);
  EXPECT_NEAR(axes[1].x, -0.5, 1e-15);
  EXPECT_EQ(axes[2], (Vec3{0, 0, 1}));
}

double any_finite() {
  const auto value = std::bit_cast<double>(*rc::gen::arbitrary<std::uint64_t>());
  return std::isfinite(value) ? value : 1;
}

void expect_orthonormal(const Axes& axes) {
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      RC_ASSERT(std::abs(dot(axes[i], axes[j]) - (i == j ? 1 : 0)) < 1e-15);
  const Vec3 across = cross(axes[0], axes[1]);
  RC_ASSERT(std::abs(dot(across, axes[2]) - 1) < 2e-15);
}

RC_GTEST_PROP(Edits, AxesAreOrthonormalAndRightHanded, ()) {
  const Vec3 v{any_finite(), any_finite(), any_finite()};
  expect_orthonormal(turned(v));
  RC_PRE(v != Vec3{});
  expect_orthonormal(along(v));
  const auto small = rc::gen::inRange(-3, 4);
  const Vec3 w{1.0 * *small, 1.0 * *small, 1.0 * *small};
  RC_PRE(w != Vec3{});
  expect_orthonormal(along(w));
}

}  // namespace
}  // namespace voxweld
