#include "tests/support/sign_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace voxweld::testing {
namespace {

TEST(SignGrid, OneSampleHasSixCrossings) {
  const SignGrid grid({1, 1, 1}, [](Index3) { return true; });
  EXPECT_TRUE(grid.inside({1, 1, 1}));
  EXPECT_FALSE(grid.inside({0, 1, 1}));
  EXPECT_FALSE(grid.inside({2, 1, 1}));
  EXPECT_FALSE(grid.inside({-5, 1, 9}));
  EXPECT_EQ(count_crossings(grid), (CrossingCounts{2, 2, 2}));
}

TEST(SignGrid, CountsAFullBoxAtItsBorderOnly) {
  const SignGrid grid({3, 4, 5}, [](Index3) { return true; });
  EXPECT_EQ(count_crossings(grid), (CrossingCounts{2 * 20, 2 * 15, 2 * 12}));
}

TEST(SignGrid, CountsALayerInside) {
  const SignGrid grid({3, 3, 3}, [](Index3 p) { return p.z == 1; });
  EXPECT_EQ(count_crossings(grid), (CrossingCounts{6, 6, 18}));
}

TEST(SignGrid, ReadsSamplesXFastest) {
  const std::vector<std::uint16_t> samples = {9, 1, 9, 9, 9, 9};
  const SignGrid grid = signs_of<std::uint16_t>(
      {2, 3, 1}, samples, [](std::uint16_t v) { return inside_below(v, 1.0); });
  EXPECT_TRUE(grid.inside({2, 1, 1}));
  EXPECT_EQ(count_crossings(grid).total(), 6);
}

TEST(SignGrid, TestsRunInTheSamplesOwnType) {
  EXPECT_TRUE(inside_below(std::uint8_t{5}, 5.0));
  EXPECT_FALSE(inside_below(std::uint8_t{5}, 4.5));
  EXPECT_FALSE(inside_below(std::nan(""), 5.0));
  EXPECT_FALSE(inside_above(std::nanf(""), 5.0));
  constexpr double two_to_60 = 1152921504606846976.0;
  const std::uint64_t next = (std::uint64_t{1} << 60) + 1;  // rounds to 2^60 as a double
  EXPECT_FALSE(inside_below(next, two_to_60));
  EXPECT_TRUE(inside_below(next - 1, two_to_60));
  EXPECT_TRUE(inside_above(next, two_to_60));
}

}  // namespace
}  // namespace voxweld::testing
