#include "pipeline/config/degrees.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <bit>
#include <cmath>
#include <numbers>

namespace voxweld {
namespace {

void expect_exactly(double degrees, double sine, double cosine) {
  const SineCosine found = sine_cosine_of_degrees(degrees);
  EXPECT_EQ(std::bit_cast<std::uint64_t>(found.sine), std::bit_cast<std::uint64_t>(sine))
      << degrees;
  EXPECT_EQ(std::bit_cast<std::uint64_t>(found.cosine), std::bit_cast<std::uint64_t>(cosine))
      << degrees;
}

TEST(Degrees, QuarterTurnsAreExact) {
  for (const double turns : {0.0, 1.0, -1.0, 7.0, -1000.0, 0x1p40, -0x1p40}) {
    expect_exactly(360 * turns, 0, 1);
    expect_exactly(360 * turns + 90, 1, 0);
    expect_exactly(360 * turns + 180, 0, -1);
    expect_exactly(360 * turns + 270, -1, 0);
  }
  expect_exactly(-0.0, 0, 1);
  expect_exactly(-90, -1, 0);
  expect_exactly(360 * 0x1p900, 0, 1);
}

// The bits are part of the result, so they are said here once.
TEST(Degrees, BitsStayAsTheyAre) {
  EXPECT_EQ(sine_cosine_of_degrees(30).sine, 0x1.fffffffffffffp-2);
  EXPECT_EQ(sine_cosine_of_degrees(30).cosine, 0x1.bb67ae8584cabp-1);
  EXPECT_EQ(sine_cosine_of_degrees(45).sine, 0x1.6a09e667f3bccp-1);
  EXPECT_EQ(sine_cosine_of_degrees(45).cosine, 0x1.6a09e667f3bcdp-1);
  EXPECT_EQ(sine_cosine_of_degrees(-123.456).sine, -0x1.ab2a9b25a9ab9p-1);
  EXPECT_EQ(sine_cosine_of_degrees(-123.456).cosine, -0x1.1a43870d371f9p-1);
}

void expect_near_the_library(double degrees) {
  const long double x = std::fmod(static_cast<long double>(degrees), 360.0L) *
                        std::numbers::pi_v<long double> / 180.0L;
  const SineCosine found = sine_cosine_of_degrees(degrees);
  EXPECT_NEAR(found.sine, static_cast<double>(std::sin(x)), 0x1p-52) << degrees;
  EXPECT_NEAR(found.cosine, static_cast<double>(std::cos(x)), 0x1p-52) << degrees;
}

TEST(Degrees, AgreeWithTheLibrary) {
  for (int i = -72000; i <= 72000; ++i) expect_near_the_library(i * 0.01);
  for (const double d : {1e-300, 44.99999999999999, 45.00000000000001, 134.99999999999997, 1e6})
    expect_near_the_library(d);
  for (const double degrees : {30.0, 60.0, 17.25, -80.5, 89.0}) {
    EXPECT_NEAR(sine_cosine_of_degrees(degrees).sine, std::sin(degrees * (std::numbers::pi / 180)),
                1e-15);
    EXPECT_NEAR(sine_cosine_of_degrees(degrees).cosine,
                std::cos(degrees * (std::numbers::pi / 180)), 1e-15);
  }
}

RC_GTEST_PROP(Degrees, LieOnTheUnitCircle, (std::uint64_t bits)) {
  const auto degrees = std::bit_cast<double>(bits);
  RC_PRE(std::isfinite(degrees));
  const SineCosine found = sine_cosine_of_degrees(degrees);
  RC_ASSERT(std::abs(found.sine * found.sine + found.cosine * found.cosine - 1) <= 0x1p-50);
}

}  // namespace
}  // namespace voxweld
