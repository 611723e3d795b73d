// Isovalues of a file's real values, in the numbers it stores; and those beyond 2^53.
#include "stages/contouring/stored_surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "stages/contouring/inside_test.h"

namespace voxweld {
namespace {

template <class T>
constexpr SampleType type_of() {
  if constexpr (std::is_same_v<T, std::uint8_t>) return SampleType::u8;
  if constexpr (std::is_same_v<T, std::int16_t>) return SampleType::i16;
  if constexpr (std::is_same_v<T, std::int32_t>) return SampleType::i32;
  if constexpr (std::is_same_v<T, std::int64_t>) return SampleType::i64;
  if constexpr (std::is_same_v<T, std::uint64_t>) return SampleType::u64;
  if constexpr (std::is_same_v<T, float>) return SampleType::f32;
  return SampleType::f64;
}

constexpr double slopes[] = {2, -1, 0.1, -0.37, 0x1.99999ap-4, 1e-3, 3e5, -1e-300, 1};
constexpr double intercepts[] = {0, -1024, 0.5, 1e6, -0.1};

template <class T>
void expect_as_real(const std::vector<T>& values, const ValueScale& scale, double isovalue) {
  for (const Inside inside : {Inside::above, Inside::below}) {
    SurfaceParameters surface;
    surface.isovalue = isovalue;
    surface.inside = inside;
    to_stored(surface, scale, type_of<T>());
    const InsideTest<T> test = make_inside_test<T>(surface.isovalue, surface.inside);
    for (const T v : values) {
      const double real = scale.slope * static_cast<double>(v) + scale.intercept;
      ASSERT_EQ(test(v), inside == Inside::above ? real >= isovalue : real <= isovalue)
          << +v << ", " << scale.slope << " * v + " << scale.intercept << " at " << isovalue;
    }
  }
}

// Isovalues at, just beside and between the real values of some samples, and far from all.
template <class T>
void expect_as_real_everywhere(const std::vector<T>& values, const std::vector<T>& asked) {
  for (const double slope : slopes)
    for (const double intercept : intercepts) {
      const ValueScale scale{slope, intercept};
      if (scale.identity()) continue;  // then integers are compared exactly
      for (const T v : asked) {
        const double at = scale.real(static_cast<double>(v));
        for (const double isovalue : {at, std::nextafter(at, -1e308), std::nextafter(at, 1e308),
                                      at + 0.5 * slope, at - 0.3 * slope})
          if (std::isfinite(isovalue)) expect_as_real(values, scale, isovalue);
      }
      for (const double isovalue : {-1e300, 1e300}) expect_as_real(values, scale, isovalue);
    }
}

template <class T>
std::vector<T> around(std::initializer_list<T> middles) {
  std::vector<T> values;
  for (const T middle : middles)
    for (int d = -20; d <= 20; ++d)
      values.push_back(static_cast<T>(static_cast<std::make_unsigned_t<T>>(middle) +
                                      static_cast<std::make_unsigned_t<T>>(d)));
  return values;
}

TEST(StoredSurface, DecidesAsRealValuesAreCompared) {
  std::vector<std::uint8_t> bytes;
  for (int v = 0; v < 256; ++v) bytes.push_back(static_cast<std::uint8_t>(v));
  expect_as_real_everywhere<std::uint8_t>(bytes, {0, 1, 77, 254, 255});
  std::vector<std::int16_t> shorts;
  for (int v = -32768; v < 32768; v += 7) shorts.push_back(static_cast<std::int16_t>(v));
  expect_as_real_everywhere<std::int16_t>(shorts, {-32768, -1025, 32767});
  using I32 = std::int32_t;
  const I32 last = std::numeric_limits<I32>::max();
  expect_as_real_everywhere<I32>(around<I32>({0, 1 << 30, last, -5}), {0, 1 << 30, last, -5});
}

TEST(StoredSurface, DecidesAsRealValuesAreComparedOf64BitsAndFloats) {
  using I64 = std::int64_t;
  using U64 = std::uint64_t;
  const I64 large = I64{1} << 60;
  expect_as_real_everywhere<I64>(around<I64>({0, large, -large}), {large, -large + 3, 0});
  expect_as_real_everywhere<U64>(around<U64>({0, U64{1} << 63, 20}), {U64{1} << 63, 3});
  std::mt19937 random(1);
  std::vector<float> floats = {0, -0.0F, INFINITY, -INFINITY, NAN, 1e38F, -1e38F};
  std::vector<double> doubles = {0, -0.0, INFINITY, -INFINITY, NAN, 1e308, -1e308};
  for (int i = 0; i < 200; ++i) {
    floats.push_back(static_cast<float>(random()) / 1e6F - 2000);
    doubles.push_back(static_cast<double>(random()) / 1e6 - 2000);
    floats.push_back(std::nextafter(floats.back(), 0.0F));
    doubles.push_back(std::nextafter(doubles.back(), 0.0));
  }
  expect_as_real_everywhere<float>(floats, {floats[10], floats[101], 0});
  expect_as_real_everywhere<double>(doubles, {doubles[10], doubles[101], 0});
}

TEST(StoredSurface, KeepsThePlaceBetweenSamples) {
  SurfaceParameters surface;
  surface.isovalue = 175;
  to_stored(surface, {2, -1024}, SampleType::i16);
  EXPECT_EQ(surface.isovalue, 599.5);
  EXPECT_EQ(surface.inside, Inside::above);
  surface.isovalue = 175;
  to_stored(surface, {-2, 1024}, SampleType::i16);
  EXPECT_EQ(surface.isovalue, 424.5);
  EXPECT_EQ(surface.inside, Inside::below);
  to_stored(surface, {}, SampleType::i16);
  EXPECT_EQ(surface.isovalue, 424.5);
}

template <class T>
void expect_exact(T isovalue) {
  for (const T v : around<T>({isovalue})) {
    EXPECT_EQ(make_inside_test<T>(Isovalue::of(isovalue), Inside::above)(v), v >= isovalue) << v;
    EXPECT_EQ(make_inside_test<T>(Isovalue::of(isovalue), Inside::below)(v), v <= isovalue) << v;
  }
}

TEST(LargeIsovalue, IsComparedExactly) {
  for (const std::int64_t large :
       {(std::int64_t{1} << 53) + 1, -(std::int64_t{1} << 60) - 3, (std::int64_t{1} << 62) + 1000})
    expect_exact(large);
  expect_exact(std::numeric_limits<std::uint64_t>::max() - 100);
  const auto highest = std::numeric_limits<std::int64_t>::max();
  const auto most = std::numeric_limits<std::uint64_t>::max();
  EXPECT_TRUE(make_inside_test<std::int64_t>(Isovalue::of(highest), Inside::above)(highest));
  EXPECT_FALSE(make_inside_test<std::int64_t>(Isovalue::of(highest), Inside::above)(highest - 1));
  EXPECT_FALSE(make_inside_test<std::int64_t>(Isovalue::of(most), Inside::above)(highest));
  EXPECT_TRUE(make_inside_test<std::int64_t>(Isovalue::of(most), Inside::below)(highest));
  EXPECT_FALSE(make_inside_test<std::uint8_t>(Isovalue::of(highest), Inside::above)(255));
  // Doubles beside it.
  const Isovalue odd = Isovalue::of((std::int64_t{1} << 53) + 1);
  EXPECT_FALSE(make_inside_test<double>(odd, Inside::above)(0x1p53));
  EXPECT_TRUE(make_inside_test<double>(odd, Inside::above)(0x1p53 + 2));
  EXPECT_TRUE(make_inside_test<double>(odd, Inside::below)(0x1p53));
  EXPECT_FALSE(make_inside_test<float>(odd, Inside::above)(0x1p53F));
  EXPECT_TRUE(make_inside_test<float>(odd, Inside::below)(0x1p53F));
}

TEST(LargeIsovalue, HasAnOrderAndAText) {
  const Isovalue odd = Isovalue::of((std::int64_t{1} << 53) + 1);
  EXPECT_LT(Isovalue(0x1p53), odd);
  EXPECT_LT(odd, Isovalue(0x1p53 + 2));
  EXPECT_EQ(Isovalue::of(300), Isovalue(300));
  EXPECT_EQ(isovalue_text(odd), "9007199254740993");
  EXPECT_EQ(isovalue_text(Isovalue::of(~std::uint64_t{0})), "18446744073709551615");
  EXPECT_EQ(isovalue_text(-0x1p60), "-1152921504606846976");
  EXPECT_EQ(isovalue_text(0.5), "0.5");
  EXPECT_EQ(isovalue_text(300), "300");
  EXPECT_EQ(isovalue_text(1e300), "1e+300");
}

}  // namespace
}  // namespace voxweld
