#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "stages/ingest/histogram_bins.h"
#include "stages/ingest/statistics.h"
#include "stages/ingest/threshold.h"
#include "tests/storage/store/memory_source.h"

namespace voxweld {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

template <class T>
std::span<const std::byte> raw(const std::vector<T>& values) {
  return std::as_bytes(std::span(values));
}

TEST(ValueRange, LeavesNaNsOutAndTellsOfThem) {
  const std::vector<float> values = {NAN, 3, -2, NAN, 7};
  const ValueRange range = testing::value_range(SampleType::f32, raw(values));
  EXPECT_EQ(range.lo, -2);
  EXPECT_EQ(range.hi, 7);
  EXPECT_TRUE(range.any_nan);
  EXPECT_FALSE(range.empty);
  const std::vector<float> nothing(40, NAN);
  EXPECT_TRUE(testing::value_range(SampleType::f32, raw(nothing)).empty);
  EXPECT_TRUE(testing::value_range(SampleType::f32, raw(nothing)).any_nan);
  EXPECT_TRUE(testing::value_range(SampleType::f32, {}).empty);
  const std::vector<double> infinite(3, -infinity);
  EXPECT_EQ(testing::value_range(SampleType::f64, raw(infinite)).hi, -infinity);
}

TEST(ValueRange, IsConservativeBeyondWhatDoublesHold) {
  constexpr std::uint64_t big = (std::uint64_t{1} << 53) + 1;
  const std::vector<std::uint64_t> values = {big, std::numeric_limits<std::uint64_t>::max()};
  const ValueRange range = testing::value_range(SampleType::u64, raw(values));
  EXPECT_EQ(range.lo, 9007199254740992.0);
  EXPECT_EQ(range.hi, 18446744073709551616.0);
  const std::vector<std::int64_t> other = {-static_cast<std::int64_t>(big)};
  EXPECT_EQ(testing::value_range(SampleType::i64, raw(other)).lo, -9007199254740994.0);
  EXPECT_EQ(testing::value_range(SampleType::i64, raw(other)).hi, -9007199254740992.0);
}

TEST(Histogram, BinsAscendAndNarrowTypesAreExact) {
  EXPECT_EQ(histogram_bin(std::uint8_t{255}), 255U);
  EXPECT_EQ(histogram_bin(std::int8_t{-128}), 0U);
  EXPECT_EQ(histogram_bin(std::int16_t{-2000}), 30768U);
  EXPECT_EQ(histogram_bin_value(SampleType::i16, 30768), -2000);
  EXPECT_EQ(histogram_bin(-0.0f), histogram_bin(0.0f));
  EXPECT_EQ(histogram_bin_value(SampleType::f64, histogram_bin(infinity)), infinity);
  EXPECT_EQ(histogram_bin_value(SampleType::f64, histogram_bin(-infinity)), -infinity);
  EXPECT_TRUE(std::isfinite(histogram_bin_value(SampleType::f64, histogram_bin(1e300))));
  const std::vector<double> ascending = {-infinity, -1e300, -5e10, -1,    -1e-20,
                                         0,         1e-20,  0.5,   1,     1.01,
                                         4095,      4096,   1e30,  1e300, infinity};
  for (std::size_t i = 1; i < ascending.size(); ++i)
    EXPECT_LT(histogram_bin(ascending[i - 1]), histogram_bin(ascending[i])) << ascending[i];
}

TEST(Histogram, IntegersBelow4096AreExactInWideTypesToo) {
  for (std::int32_t v = -4095; v < 4096; ++v) {
    EXPECT_EQ(histogram_bin_value(SampleType::i32, histogram_bin(v)), v);
    EXPECT_EQ(histogram_bin_value(SampleType::f32, histogram_bin(static_cast<float>(v))), v);
  }
}

RC_GTEST_PROP(HistogramProperty, BinsAreNarrowAndMonotone, (float a, float b)) {
  RC_PRE(!std::isnan(a) && !std::isnan(b));
  if (a <= b) RC_ASSERT(histogram_bin(a) <= histogram_bin(b));
  const double value = histogram_bin_value(SampleType::f32, histogram_bin(a));
  RC_ASSERT(std::abs(value - a) <= std::abs(a) / 2048);
}

RC_GTEST_PROP(HistogramProperty, PartsAddUpInAnyOrder, (std::vector<double> values)) {
  values.push_back(NAN);
  const std::size_t cut = values.size() / 2;
  const std::span<const double> all(values);
  const auto part = [&](std::span<const double> some) {
    return testing::histogram_of(SampleType::f64, std::as_bytes(some));
  };
  Histogram forward = part(all.first(cut)), backward = part(all.subspan(cut));
  const Histogram second = backward, first = forward;
  add(forward, second);
  add(backward, first);
  RC_ASSERT(forward == part(all));
  RC_ASSERT(backward == part(all));
}

TEST(Statistics, ConstantStretchesCountAsTheOthersDo) {
  std::vector<std::uint16_t> values(1000, 7);
  HistogramStatistics statistics(SampleType::u16);
  statistics.add(raw(values));
  values[3] = 9;
  statistics.add(raw(values));
  EXPECT_EQ(statistics.take().bins, (std::vector<HistogramBin>{{7, 1999}, {9, 1}}));
  EXPECT_TRUE(statistics.take().bins.empty());
}

TEST(Otsu, CutsTwoClassesHalfway) {
  std::vector<std::uint8_t> values(100, 10);
  values.insert(values.end(), 20, 200);
  const auto cut = otsu_threshold(testing::histogram_of(SampleType::u8, raw(values)));
  ASSERT_TRUE(cut.has_value());
  EXPECT_EQ(cut->value, 105);
  EXPECT_NEAR(cut->separability, 1, 1e-12);
}

TEST(Otsu, ByHand) {
  // Counts 3 1 0 2 4 of values 0 1 2 3 4. Class means for the cut after 1: 1/4 and 22/6, so
  // w0 w1 (m1 - m0)^2 = 0.4 * 0.6 * (41/12)^2 = 2.8016..; after 0: 0.3 * 0.7 * (23/7)^2 = 2.267;
  // after 3: 0.6 * 0.4 * (4 - 7/6)^2 = 1.9267. Total variance: 8.3 - 2.3^2 = 3.01.
  const std::vector<std::uint8_t> values = {0, 0, 0, 1, 3, 3, 4, 4, 4, 4};
  const auto cut = otsu_threshold(testing::histogram_of(SampleType::u8, raw(values)));
  ASSERT_TRUE(cut.has_value());
  EXPECT_EQ(cut->value, 2);
  EXPECT_NEAR(cut->separability, 0.24 * (41.0 / 12) * (41.0 / 12) / 3.01, 1e-12);
}

TEST(Otsu, HasNothingToCut) {
  const std::vector<float> constant(10, 3.5f), nothing(10, NAN), infinite(4, INFINITY);
  EXPECT_FALSE(otsu_threshold(testing::histogram_of(SampleType::f32, raw(constant))));
  EXPECT_FALSE(otsu_threshold(testing::histogram_of(SampleType::f32, raw(nothing))));
  EXPECT_FALSE(suggest_isovalue(testing::histogram_of(SampleType::f32, raw(infinite))));
  EXPECT_FALSE(suggest_isovalue(Histogram{}));
}

TEST(Quantile, OfSmallSets) {
  const std::vector<std::int16_t> values = {-5, 1, 1, 8};
  const Histogram histogram = testing::histogram_of(SampleType::i16, raw(values));
  EXPECT_EQ(quantile(histogram, 0), -5);
  EXPECT_EQ(quantile(histogram, 0.25), -5);
  EXPECT_EQ(quantile(histogram, 0.5), 1);
  EXPECT_EQ(quantile(histogram, 0.76), 8);
  EXPECT_EQ(quantile(histogram, 1), 8);
  EXPECT_FALSE(quantile(Histogram{}, 0.5));
}

std::vector<std::int16_t> two_materials() {
  std::mt19937 random(1);
  std::vector<std::int16_t> values;
  for (int i = 0; i < 20000; ++i) {
    const int noise = static_cast<int>(random() % 200) - 100;
    values.push_back(static_cast<std::int16_t>((i % 3 == 0 ? 1500 : 200) + noise));
  }
  return values;
}

TEST(SuggestIsovalue, LeavesPaddingOut) {
  auto values = two_materials();
  const auto plain = suggest_isovalue(testing::histogram_of(SampleType::i16, raw(values)));
  ASSERT_TRUE(plain.has_value());
  EXPECT_FALSE(plain->padding);
  EXPECT_NEAR(plain->threshold.value, 850, 20);
  values.insert(values.end(), 8000, -2000);
  const auto padded = suggest_isovalue(testing::histogram_of(SampleType::i16, raw(values)));
  ASSERT_TRUE(padded.has_value());
  EXPECT_EQ(padded->padding, -2000);
  EXPECT_EQ(padded->threshold.value, plain->threshold.value);
}

TEST(SuggestIsovalue, IsInRealValues) {
  const std::vector<std::int16_t> values = {-5, 1, 1, 8};
  const Histogram histogram = testing::histogram_of(SampleType::i16, raw(values));
  EXPECT_EQ(quantile(histogram, 0, {2, -1024}), -1034);
  EXPECT_EQ(quantile(histogram, 1, {2, -1024}), -1008);
  EXPECT_EQ(quantile(histogram, 0, {-2, 0}), -16);
  EXPECT_EQ(quantile(histogram, 0.5, {-2, 0}), -2);
  EXPECT_EQ(quantile(histogram, 1, {-2, 0}), 10);
  auto scan = two_materials();
  scan.insert(scan.end(), 8000, -2000);
  const Histogram padded = testing::histogram_of(SampleType::i16, raw(scan));
  const auto stored = suggest_isovalue(padded);
  for (const double slope : {0.5, -0.5}) {
    const auto real = suggest_isovalue(padded, {slope, 100});
    ASSERT_TRUE(real.has_value());
    EXPECT_EQ(real->padding, slope * -2000 + 100);
    EXPECT_NEAR(real->threshold.value, slope * stored->threshold.value + 100, 1);
  }
}

TEST(SuggestIsovalue, SaysWhyThereIsNone) {
  const std::vector<std::int16_t> same(10, 7);
  EXPECT_EQ(no_threshold_text(testing::histogram_of(SampleType::i16, raw(same)), {2, 1}),
            "have one value, 15");
  std::vector<std::uint64_t> large;
  for (std::uint64_t i = 0; i < 1000; ++i) large.push_back((std::uint64_t{1} << 60) + i);
  const Histogram one_bin = testing::histogram_of(SampleType::u64, raw(large));
  EXPECT_FALSE(suggest_isovalue(one_bin));
  EXPECT_EQ(no_threshold_text(one_bin),
            "have one value or lie too close together for a histogram: from 1152921504606846976 to "
            "1153484454560268288");
  const std::vector<float> infinite(4, INFINITY);
  EXPECT_EQ(no_threshold_text(testing::histogram_of(SampleType::f32, raw(infinite))),
            "are no finite numbers");
}

TEST(SuggestIsovalue, KeepsAMaskedBackground) {
  std::mt19937 random(1);
  std::vector<std::int16_t> values(9000, 0);
  for (int i = 0; i < 3000; ++i) values.push_back(static_cast<std::int16_t>(1000 + random() % 200));
  const auto suggestion = suggest_isovalue(testing::histogram_of(SampleType::i16, raw(values)));
  ASSERT_TRUE(suggestion.has_value());
  EXPECT_FALSE(suggestion->padding);
  EXPECT_NEAR(suggestion->threshold.value, 500, 1);
}

}  // namespace
}  // namespace voxweld
