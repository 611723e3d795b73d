// NaN, infinities, ties, the ends of types, and what a filter leaves as it was.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/stages/filter/plain_filters.h"

namespace voxweld {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using testing::filtered;
using testing::Grid;
using testing::type_of;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

template <class T>
Grid<T> row_of(const std::vector<T>& values) {
  return {{static_cast<std::int64_t>(values.size()), 1, 1}, values};
}
template <class T>
SampleGrid shape_of(const Grid<T>& in) {
  return {in.size, type_of<T>()};
}

template <class Out, class T>
std::vector<Out> windowed(const std::vector<T>& values, WindowParameters p) {
  const auto in = row_of(values);
  p.type = type_of<Out>();
  return filtered<Out>(*window_kernel(shape_of(in), p), in);
}

TEST(FilterWindow, TiesGoToTheEvenNumber) {
  const std::vector<double> halves{-1.5, -0.5, 0.5, 1.5, 2.5, 254.5, 255.5};
  EXPECT_THAT(windowed<std::uint8_t>(halves, {.lo = -5, .hi = 300}),
              ElementsAre(0, 0, 0, 2, 2, 254, 255));
  EXPECT_THAT(windowed<std::int64_t>(halves, {.lo = -5, .hi = 300}),
              ElementsAre(-2, 0, 0, 2, 2, 254, 256));
  EXPECT_THAT(windowed<std::uint32_t>(halves, {.lo = -5, .hi = 300}),
              ElementsAre(0, 0, 0, 2, 2, 254, 256));
}

template <class T>
void expect_kept_within() {
  const std::vector<double> values{nan, -infinity, infinity, -1e300, 1e300, 1e19, -1e19};
  const T least = std::numeric_limits<T>::min(), most = std::numeric_limits<T>::max();
  EXPECT_THAT((windowed<T>(values, {.lo = -1e300, .hi = 1e300})),
              ElementsAre(0, least, most, least, most, most, least));
}

TEST(FilterWindow, IntegersStayWithinTheirTypeAndNanIsZero) {
  expect_kept_within<std::uint8_t>();
  expect_kept_within<std::int8_t>();
  expect_kept_within<std::uint16_t>();
  expect_kept_within<std::int16_t>();
  expect_kept_within<std::uint32_t>();
  expect_kept_within<std::int32_t>();
  expect_kept_within<std::int64_t>();
  EXPECT_THAT(windowed<std::uint64_t>(std::vector<double>{nan, -3, 1e20, 0x1p64, 0x1p63, infinity},
                                      {.lo = -1e300, .hi = 1e300}),
              ElementsAre(0, 0, ~std::uint64_t{0}, ~std::uint64_t{0}, std::uint64_t{1} << 63,
                          ~std::uint64_t{0}));
}

TEST(FilterWindow, NanStaysAmongFloatsAndTheEndsAreExact) {
  const auto out = windowed<float>(std::vector<double>{nan, -infinity, 0.1, 0.3, 0.7, infinity},
                                   {.lo = 0.1, .hi = 0.7, .scale = {{-3, 5}}});
  EXPECT_TRUE(std::isnan(out[0]));
  EXPECT_EQ(out[1], -3);
  EXPECT_EQ(out[2], -3);
  EXPECT_NEAR(out[3], -3 + 8 / 3.0, 1e-6);
  EXPECT_EQ(out[4], 5);
  EXPECT_EQ(out[5], 5);
}

TEST(FilterWindow, AScaleThatIsTheRangeChangesNothing) {
  std::vector<std::uint16_t> all(65536);
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint16_t>(i);
  EXPECT_EQ(windowed<std::uint16_t>(all, {.lo = 0, .hi = 65535, .scale = {{0, 65535}}}), all);
  const auto turned = windowed<std::uint16_t>(all, {.lo = 0, .hi = 65535, .scale = {{65535, 0}}});
  EXPECT_TRUE(std::equal(turned.rbegin(), turned.rend(), all.begin(), all.end()));
}

TEST(FilterMean, NanIsWhereOneOfTheBoxIs) {
  const auto in = row_of<float>({1, 2, static_cast<float>(nan), 4, 5, 6, 7, 8, 9, 10});
  const auto out = filtered<float>(*mean_kernel(shape_of(in), {1, 0, 0}, SampleType::f32), in);
  for (std::size_t x = 0; x < out.size(); ++x) EXPECT_EQ(std::isnan(out[x]), x >= 1 && x <= 3);
  EXPECT_EQ(out[4], 5);
  EXPECT_EQ(out[0], static_cast<float>(4 / 3.0));
}

TEST(FilterMedian, NansAreTheLargest) {
  const auto f = [](double v) { return static_cast<float>(v); };
  const auto in = row_of<float>({f(nan), 1, f(nan), f(nan), f(infinity), f(-infinity), 2});
  for (const Index3 radius : {Index3{1, 0, 0}, Index3{1, 1, 0}, Index3{1, 1, 1}}) {
    const auto out = filtered<float>(*median_kernel(shape_of(in), radius), in);
    EXPECT_TRUE(std::isnan(out[0]) && std::isnan(out[1]) && std::isnan(out[2]) &&
                std::isnan(out[3]));
    EXPECT_EQ(out[4], infinity);
    EXPECT_EQ(out[5], 2);
    EXPECT_EQ(out[6], 2);
  }
}

// All 2^27 would be too many: any network that finds the medians of zeros and ones finds all. Here
// each count of ones beside the middle, spread at random.
TEST(FilterMedian, OfZerosAndOnes) {
  std::mt19937_64 random(5);
  for (int i = 0; i < 4000; ++i) {
    const auto in = Grid<std::uint8_t>::made(
        splat(3), [&](Index3) { return static_cast<std::uint8_t>(random() % 2); });
    const auto ones = std::count(in.values.begin(), in.values.end(), 1);
    const auto out =
        filtered<std::uint8_t>(*median_kernel(shape_of(in), splat(1)), in, {splat(1), splat(2)});
    ASSERT_EQ(out[0], ones > 13 ? 1 : 0);
  }
}

TEST(FilterDownsample, NanIsTheGreatestAndZerosAreOneValue) {
  const auto in = row_of<double>({1, nan, -0.0, 0.0, 0.0, 5, nan, nan});
  const Index3 factor{4, 1, 1};
  const auto greatest = filtered<double>(
      *downsample_kernel(shape_of(in), factor, DownsampleMethod::max, SampleType::f64), in);
  EXPECT_TRUE(std::isnan(greatest[0]) && std::isnan(greatest[1]));
  const auto mode = filtered<double>(
      *downsample_kernel(shape_of(in), factor, DownsampleMethod::mode, SampleType::f64), in);
  EXPECT_EQ(mode[0], 0);
  EXPECT_TRUE(std::isnan(mode[1]));
}

// Sums of the largest values of a type, in whatever they are summed.
TEST(FilterMean, TheLargestValuesDoNotOverflow) {
  for (const std::int64_t radius : {1, 3, 9, 20}) {
    const auto words = Grid<std::uint16_t>::made({5, 4, 3}, [](Index3) { return 65535; });
    EXPECT_THAT(filtered<std::uint16_t>(
                    *mean_kernel(shape_of(words), splat(radius), SampleType::u16), words),
                Each(65535));
    const auto longs = Grid<std::int64_t>::made(
        {5, 4, 3}, [](Index3) { return std::numeric_limits<std::int64_t>::min(); });
    EXPECT_THAT(filtered<std::int64_t>(
                    *mean_kernel(shape_of(longs), splat(radius), SampleType::i64), longs),
                Each(std::numeric_limits<std::int64_t>::min()));
  }
}

TEST(FilterGaussian, OfAConstantIsTheConstant) {
  const auto in = Grid<std::uint16_t>::made({9, 8, 7}, [](Index3) { return 40000; });
  for (const double sigma : {0.0, 0.1, 0.2, 1.0, 2.5, 7.0})
    EXPECT_THAT(filtered<std::uint16_t>(
                    *gaussian_kernel(shape_of(in), {sigma, sigma, sigma}, SampleType::u16), in),
                Each(40000));
}

// The order of the sums does not depend on the direction.
TEST(FilterGaussian, OfAVolumeTurnedAroundIsTurnedAround) {
  std::mt19937_64 random(9);
  const auto in = testing::random_grid<double>({17, 12, 9}, random, false);
  const SampleGrid shape = shape_of(in);
  const auto flip = flip_kernel(shape, {true, true, true});
  const auto smooth = gaussian_kernel(shape, {1.25, 0.5, 2}, SampleType::f64);
  const Grid<double> turned{in.size, filtered<double>(*flip, in)};
  const Grid<double> smoothed{in.size, filtered<double>(*smooth, in)};
  EXPECT_EQ(filtered<double>(*smooth, turned), filtered<double>(*flip, smoothed));
}

}  // namespace
}  // namespace voxweld
