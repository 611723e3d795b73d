#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "stages/ingest/noise_level.h"
#include "tests/support/lattice_place.h"

namespace voxweld {
namespace {

using Field = std::function<double(Vec3)>;

template <class T>
std::vector<T> made(Index3 size, const Field& field) {
  std::vector<T> samples;
  each_index(size,
             [&](Index3 s) { samples.push_back(static_cast<T>(field(testing::as_vec3(s)))); });
  return samples;
}
template <class T>
NoiseMeter meter_of(SampleType type, double isovalue, Index3 size, const Field& field) {
  NoiseMeter meter(type, Isovalue(isovalue));
  meter.add(size, reinterpret_cast<const std::byte*>(made<T>(size, field).data()));
  return meter;
}
double level_of(const Field& field) {
  return meter_of<double>(SampleType::f64, 0, splat(48), field).level();
}

double ball(Vec3 p) {
  const Vec3 d = p - Vec3{23.2, 24.1, 23.7};
  return std::sqrt(dot(d, d)) - 15.3;
}
// Eight slabs with sharp edges, turned.
double slabs(Vec3 p) {
  const double u = dot(p, Vec3{0.8, 0.36, 0.48}), v = dot(p, Vec3{-0.6, 0.48, 0.64});
  return std::max(std::abs(std::remainder(u, 8)) - 2.1, 8 - std::abs(v));
}
Field with_noise(const Field& field, double deviation) {
  return [field, deviation, random = std::mt19937(1), normal = std::normal_distribution<double>()](
             Vec3 p) mutable { return field(p) + deviation * normal(random); };
}

TEST(NoiseLevel, IsThatOfTheNoiseOnSmoothAndSharpSolids) {
  for (const Field& field : {Field(ball), Field(slabs)})
    for (const double deviation : {0.02, 0.1, 0.4}) {
      SCOPED_TRACE(deviation);
      const double level = level_of(with_noise(field, deviation));
      EXPECT_GE(level, deviation / 1.25);
      EXPECT_LE(level, deviation * 2);
    }
}

TEST(NoiseLevel, OfCleanDistancesIsNearlyNone) {
  EXPECT_LT(level_of(ball), 0.002);
  EXPECT_LT(level_of(slabs), 0.002);
}

TEST(NoiseLevel, OfMasksIsThatOfTheirSteps) {
  EXPECT_GT(level_of([](Vec3 p) { return ball(p) < 0 ? -1.0 : 1.0; }), 0.5);
}

TEST(NoiseLevel, GoesWithTheSamplesUnit) {
  const double one = level_of(with_noise(ball, 0.1));
  EXPECT_EQ(level_of([field = with_noise(ball, 0.1)](Vec3 p) { return 1024 * field(p); }),
            1024 * one);
}

// 1 or 1.5 times a power of two.
TEST(NoiseLevel, IsRoundedSoThatAFewSamplesDoNotMatter) {
  for (const double deviation : {0.013, 0.05, 0.11, 0.37}) {
    int exponent = 0;
    const double m = std::frexp(level_of(with_noise(ball, deviation)), &exponent);
    EXPECT_TRUE(m == 0.5 || m == 0.75) << m;
  }
}

TEST(NoiseLevel, OfIntegersIsAtLeastThatOfRounding) {
  // Steps of a whole number each: nothing else is seen.
  const auto meter =
      meter_of<std::uint8_t>(SampleType::u8, 20, splat(32), [](Vec3 p) { return 4 + p.x; });
  EXPECT_GT(meter.count(), 100U);
  EXPECT_EQ(meter.level(), 0.25);  // 1 / sqrt(12), rounded
}

TEST(NoiseLevel, WithoutASurfaceIsNone) {
  const auto meter = meter_of<float>(SampleType::f32, 0, splat(16), [](Vec3) { return 1.0; });
  EXPECT_EQ(meter.count(), 0U);
  EXPECT_EQ(meter.level(), 0);
}

TEST(NoiseLevel, IsTheSameInWhateverOrderBoxesCome) {
  const Index3 size{20, 21, 22};
  const auto a = made<float>(size, with_noise([](Vec3 p) { return p.x - 9.4; }, 0.1));
  const auto b = made<float>(size, with_noise([](Vec3 p) { return p.y - 9.4; }, 0.3));
  const auto* bytes_a = reinterpret_cast<const std::byte*>(a.data());
  const auto* bytes_b = reinterpret_cast<const std::byte*>(b.data());
  NoiseMeter one(SampleType::f32, Isovalue(0.0)), other(SampleType::f32, Isovalue(0.0));
  one.add(size, bytes_a);
  one.add(size, bytes_b);
  other.add(size, bytes_b);
  other.add(size, bytes_a);
  EXPECT_EQ(one.count(), other.count());
  EXPECT_EQ(one.level(), other.level());
}

}  // namespace
}  // namespace voxweld
