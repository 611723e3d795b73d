#include "pipeline/phantom/fields.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "pipeline/phantom/kinds.h"
#include "storage/support/error.h"
#include "tests/support/error_text.h"

namespace voxweld {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

TEST(PhantomKinds, NamesGoBothWays) {
  for (const PhantomKindInfo& info : phantom_kinds()) {
    EXPECT_EQ(parse_phantom_kind(info.name), info.kind);
    EXPECT_EQ(phantom_kind_name(info.kind), info.name);
    EXPECT_FALSE(info.summary.empty());
  }
  EXPECT_EQ(testing::error_text<InputError>([&] { parse_phantom_kind("cube"); }),
            "unknown phantom \"cube\": expected one of sphere, torus, gyroid, part, temple, "
            "labels, junctions, porous, noise");
}

TEST(PhantomKinds, QuantizesAsPublished) {
  const Quantizer u16 = phantom_quantizer(PhantomKind::gyroid, SampleType::u16);
  EXPECT_EQ(u16.sample<std::uint16_t>(0), 32768);
  EXPECT_EQ(u16.sample<std::uint16_t>(-1e-9), 32767);
  EXPECT_EQ(u16.sample<std::uint16_t>(1.5), 32768 + 3072);
  EXPECT_EQ(u16.sample<std::uint16_t>(100), 65535);
  EXPECT_EQ(u16.sample<std::uint16_t>(-100), 0);
  EXPECT_EQ(u16.limit(), 16);
  const Quantizer u8 = phantom_quantizer(PhantomKind::part, SampleType::u8);
  EXPECT_EQ(u8.sample<std::uint8_t>(-0.01), 127);
  EXPECT_EQ(u8.sample<std::uint8_t>(1), 144);
  EXPECT_EQ(phantom_quantizer(PhantomKind::part, SampleType::f32).sample<float>(-0.25), -0.25f);
  EXPECT_EQ(phantom_quantizer(PhantomKind::part, SampleType::f32).limit(), inf);
  const Quantizer porous = phantom_quantizer(PhantomKind::porous, SampleType::u16);
  EXPECT_EQ(porous.sample<std::uint16_t>(1), 32768 + 800);
  const Quantizer labels = phantom_quantizer(PhantomKind::labels, SampleType::u8);
  EXPECT_EQ(labels.sample<std::uint8_t>(216), 216);
}

TEST(PhantomKinds, IsovaluesLieOnTheSurface) {
  EXPECT_EQ(phantom_isovalue(PhantomKind::sphere, SampleType::u16), 32767.5);
  EXPECT_EQ(phantom_isovalue(PhantomKind::porous, SampleType::u8), 127.5);
  EXPECT_EQ(phantom_isovalue(PhantomKind::noise, SampleType::f32), 0.0);
  EXPECT_EQ(phantom_isovalue(PhantomKind::labels, SampleType::u16), std::nullopt);
  EXPECT_THROW(phantom_isovalue(PhantomKind::labels, SampleType::f32), InputError);
  EXPECT_THROW(phantom_quantizer(PhantomKind::sphere, SampleType::i16), InputError);
}

TEST(PhantomFields, RefusesSizesOutOfRange) {
  EXPECT_THROW(make_phantom_field(PhantomKind::sphere, 0, 1), InputError);
  EXPECT_THROW(make_phantom_field(PhantomKind::noise, std::int64_t{1} << 19, 1), InputError);
  EXPECT_THROW(make_analytic_field(PhantomKind::porous, 64), InputError);
}

TEST(PhantomFields, SphereByHand) {
  const auto field = make_analytic_field(PhantomKind::sphere, 101);
  EXPECT_DOUBLE_EQ(field->at({50, 50, 50}), -40.4);
  EXPECT_DOUBLE_EQ(field->at({53, 54, 50}), 5 - 40.4);
  EXPECT_DOUBLE_EQ(field->surface_distance({50, 50, 0}), 9.6);
}

TEST(PhantomFields, TorusByHand) {
  const auto field = make_analytic_field(PhantomKind::torus, 101);
  EXPECT_DOUBLE_EQ(field->at({50, 50, 50}), 0.29 * 101 - 0.12 * 101);
  // Its axis is q = (0, 0, 1), that is p - c = Rx(-0.4) Ry(-0.5) z.
  const Vec3 axis{-std::sin(0.5), std::sin(0.4) * std::cos(0.5), std::cos(0.4) * std::cos(0.5)};
  const Vec3 above = Vec3{50, 50, 50} + axis * 7;
  EXPECT_NEAR(field->at(above), std::hypot(0.29 * 101, 7) - 0.12 * 101, 1e-12);
}

TEST(PhantomFields, GyroidByHand) {
  const double n = 121, k = 2 * std::numbers::pi / 12.1, a = 1 / (1.4 * k);
  const auto field = make_analytic_field(PhantomKind::gyroid, 121);
  // In the middle the ball is far, so only the gyroid counts.
  const double g = a * (std::sin(0.3) * std::cos(0.7) + std::sin(0.7) * std::cos(1.1) +
                        std::sin(1.1) * std::cos(0.3));
  EXPECT_NEAR(field->at({60, 60, 60}), g, 1e-12);
  // In the corner only the ball.
  EXPECT_NEAR(field->at({0, 0, 0}), 60 * std::sqrt(3.0) - 0.45 * n, 1e-12);
  // Where both are equal, the blend adds r / 4.
  Vec3 p{60, 60, 113};
  double nearest = inf;
  for (double z = 110; z < 120; z += 0.001) {
    const double X = 0.3, Y = 0.7, Z = k * (z - 60) + 1.1, b = z - 60 - 0.45 * n;
    const double u =
        a * (std::sin(X) * std::cos(Y) + std::sin(Y) * std::cos(Z) + std::sin(Z) * std::cos(X));
    if (std::abs(u - b) < nearest) {
      nearest = std::abs(u - b);
      p.z = z;
    }
  }
  EXPECT_NEAR(field->at(p), p.z - 60 - 0.45 * n + 6 * n / 512 / 4, 0.002);
}

// Against numeric differentiation, within half a voxel of the surface.
TEST(PhantomFields, GyroidDistanceIsValueOverSlope) {
  const auto field = make_analytic_field(PhantomKind::gyroid, 256);
  constexpr double h = 1e-5;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 p{128 + 117 * std::sin(i * 1.0), 128 + 117 * std::sin(i * 1.7),
                 128 + 117 * std::sin(i * 2.3)};
    Vec3 gradient;
    for (int axis = 0; axis < 3; ++axis) {
      Vec3 a = p, b = p;
      a[axis] -= h;
      b[axis] += h;
      gradient[axis] = (field->at(b) - field->at(a)) / (2 * h);
    }
    const double slope = std::sqrt(dot(gradient, gradient));
    if (slope < 0.2) continue;
    EXPECT_NEAR(field->surface_distance(p), std::abs(field->at(p)) / slope, 1e-4);
  }
}

// In whatever box a sample is asked for it has the same bits, and those of the formula.
TEST(PhantomFields, BoxesAgreeWithPoints) {
  const std::int64_t n = 33;
  for (const PhantomKindInfo& info : phantom_kinds()) {
    const auto field = make_phantom_field(info.kind, n, 5);
    const auto* analytic = dynamic_cast<const AnalyticField*>(field.get());
    std::vector<double> whole(static_cast<std::size_t>(n * n * n)), part;
    field->fill({{0, 0, 0}, splat(n)}, inf, whole.data());
    for (const Box3& box : {Box3{{3, 0, 31}, {9, 33, 33}}, Box3{{0, 7, 7}, {33, 8, 8}},
                            Box3{{30, 30, 1}, {33, 31, 20}}}) {
      part.assign(static_cast<std::size_t>(box.count()), 0);
      field->fill(box, inf, part.data());
      std::size_t i = 0;
      for (std::int64_t z = box.lo.z; z < box.hi.z; ++z)
        for (std::int64_t y = box.lo.y; y < box.hi.y; ++y)
          for (std::int64_t x = box.lo.x; x < box.hi.x; ++x, ++i) {
            ASSERT_EQ(part[i], whole[static_cast<std::size_t>((z * n + y) * n + x)]) << info.name;
            if (analytic != nullptr) {
              const Vec3 p{static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
              ASSERT_EQ(part[i], analytic->at(p)) << info.name;
            }
          }
    }
  }
}

TEST(PhantomFields, LabelsAreTheNearestPoints) {
  const std::int64_t n = 61;
  const auto field = make_phantom_field(PhantomKind::labels, n, 3);
  std::vector<double> labels(static_cast<std::size_t>(n * n * n));
  field->fill({{0, 0, 0}, splat(n)}, inf, labels.data());
  std::vector<int> count(217);
  for (const double label : labels) ++count.at(static_cast<std::size_t>(label));
  EXPECT_EQ(labels[0], 0) << "corners lie outside the ball";
  const double ball = 4.0 / 3 * std::numbers::pi * std::pow(0.45 * n, 3);
  EXPECT_NEAR(static_cast<double>(labels.size()) - count[0], ball, 0.02 * ball);
  std::vector<double> again(labels.size());
  make_phantom_field(PhantomKind::labels, n, 4)->fill({{0, 0, 0}, splat(n)}, inf, again.data());
  EXPECT_NE(labels, again) << "the seed matters";
}

TEST(PhantomFields, NoiseIsFairAndNeverZero) {
  const std::int64_t n = 48;
  const auto field = make_phantom_field(PhantomKind::noise, n, 1);
  std::vector<double> values(static_cast<std::size_t>(n * n * n));
  field->fill({{0, 0, 0}, splat(n)}, inf, values.data());
  double inside = 0, neighbours = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    ASSERT_TRUE(values[i] > -8 && values[i] < 8 && values[i] != 0);
    inside += values[i] < 0;
    if (i > 0) neighbours += values[i] * values[i - 1];
  }
  EXPECT_NEAR(inside / static_cast<double>(values.size()), 0.5, 0.006);
  EXPECT_NEAR(neighbours / static_cast<double>(values.size()), 0, 0.3);
}

}  // namespace
}  // namespace voxweld
