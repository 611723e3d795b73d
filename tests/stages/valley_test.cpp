#include "stages/ingest/valley.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "stages/ingest/statistics.h"

namespace voxweld {
namespace {

template <class T>
Histogram histogram_of(SampleType type, const std::vector<T>& values) {
  HistogramStatistics statistics(type);
  statistics.add(std::as_bytes(std::span(values)));
  return statistics.take();
}

struct Material {
  double mean, deviation;
  int samples;
};

// Normally distributed, rounded to integers, by sums of twelve uniform numbers: the same everywhere.
std::vector<double> samples_of(const std::vector<Material>& materials) {
  std::mt19937 random(1);
  std::vector<double> values;
  for (const Material& m : materials)
    for (int i = 0; i < m.samples; ++i) {
      double sum = -6;
      for (int k = 0; k < 12; ++k) sum += static_cast<double>(random()) / 0x1p32;
      values.push_back(std::round(m.mean + m.deviation * sum));
    }
  return values;
}

template <class T>
std::optional<IsovalueSuggestion> valley_of(SampleType type, const std::vector<double>& values,
                                            const ValueScale& scale = {}) {
  std::vector<T> samples(values.size());
  std::ranges::transform(values, samples.begin(), [](double v) { return static_cast<T>(v); });
  return suggest_isovalue(histogram_of(type, samples), scale, IsovalueRule::valley);
}

// One of a hundred samples is bone. Otsu cuts the soft tissue; the valley lies before the bone.
TEST(Valley, FindsARareMaterial) {
  const auto values = samples_of({{1000, 60, 300000}, {2000, 80, 3000}});
  const auto valley = valley_of<std::int16_t>(SampleType::i16, values);
  ASSERT_TRUE(valley);
  EXPECT_GT(valley->threshold.value, 1250);
  EXPECT_LT(valley->threshold.value, 1800);
  EXPECT_GT(valley->threshold.separability, 0.95);
}

TEST(Valley, LiesWhereTheDensitiesOfTwoMaterialsAreLowest) {
  // Equal weights and deviations: in the middle.
  const auto values = samples_of({{300, 60, 100000}, {700, 60, 100000}});
  const auto valley = valley_of<std::uint16_t>(SampleType::u16, values);
  ASSERT_TRUE(valley);
  EXPECT_NEAR(valley->threshold.value, 500, 25);
}

TEST(Valley, OfThreeMaterialsPartsTheClearestTwo) {
  // The peak at 900 is the shoulder of that at 1000.
  const auto values = samples_of({{0, 30, 100000}, {900, 40, 60000}, {1000, 40, 100000}});
  const auto valley = valley_of<std::int16_t>(SampleType::i16, values);
  ASSERT_TRUE(valley);
  EXPECT_GT(valley->threshold.value, 120);
  EXPECT_LT(valley->threshold.value, 760);
}

TEST(Valley, IsInTheMiddleOfAnEmptyStretch) {
  const auto values = samples_of({{1000, 10, 50000}, {9000, 10, 50000}});
  const auto valley = valley_of<std::uint16_t>(SampleType::u16, values);
  ASSERT_TRUE(valley);
  EXPECT_NEAR(valley->threshold.value, 5000, 200);
  EXPECT_EQ(valley->threshold.separability, 1);
}

TEST(Valley, ThereIsNoneWhereThereIsOnePeak) {
  EXPECT_FALSE(valley_of<std::int16_t>(SampleType::i16, samples_of({{500, 80, 200000}})));
  EXPECT_FALSE(valley_of<std::int16_t>(SampleType::i16, samples_of({{500, 80, 300}})));
  EXPECT_FALSE(valley_of<std::int16_t>(SampleType::i16, std::vector<double>(100, 7)));
  EXPECT_FALSE(valley_of<float>(SampleType::f32, {}));
}

// Twelve bits stored in sixteen: fifteen of sixteen bins are empty.
TEST(Valley, IsNotFooledByACombOfValues) {
  auto values = samples_of({{500, 80, 200000}});
  for (double& value : values) value *= 16;
  EXPECT_FALSE(valley_of<std::uint16_t>(SampleType::u16, values));
  values = samples_of({{300, 40, 100000}, {700, 40, 20000}});
  const auto plain = valley_of<std::uint16_t>(SampleType::u16, values);
  for (double& value : values) value *= 16;
  const auto comb = valley_of<std::uint16_t>(SampleType::u16, values);
  ASSERT_TRUE(plain && comb);
  EXPECT_NEAR(comb->threshold.value / 16, plain->threshold.value, 30);
}

TEST(Valley, IsTheSameInAllTypesAndScales) {
  const auto values = samples_of({{300, 40, 100000}, {700, 40, 20000}});
  const auto plain = valley_of<std::int16_t>(SampleType::i16, values);
  ASSERT_TRUE(plain);
  const double width = 4;  // of a cell, or less
  EXPECT_NEAR(valley_of<float>(SampleType::f32, values)->threshold.value, plain->threshold.value,
              2 * width);
  EXPECT_NEAR(valley_of<std::int32_t>(SampleType::i32, values)->threshold.value,
              plain->threshold.value, 2 * width);
  const auto turned = valley_of<std::int16_t>(SampleType::i16, values, {-2, 100});
  ASSERT_TRUE(turned);
  EXPECT_NEAR(turned->threshold.value, -2 * plain->threshold.value + 100, 2 * width * 2);
}

TEST(Valley, LeavesPaddingOut) {
  auto values = samples_of({{300, 40, 100000}, {700, 40, 20000}});
  const auto plain = valley_of<std::int16_t>(SampleType::i16, values);
  values.insert(values.end(), 50000, -2000);
  const auto padded = valley_of<std::int16_t>(SampleType::i16, values);
  ASSERT_TRUE(plain && padded);
  EXPECT_EQ(padded->padding, -2000);
  EXPECT_EQ(padded->threshold.value, plain->threshold.value);
}

}  // namespace
}  // namespace voxweld
