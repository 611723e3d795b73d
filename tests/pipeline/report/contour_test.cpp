#include "pipeline/report/contour.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

namespace voxweld {
namespace {

using ::testing::SizeIs;

// Rows from the lowest.
Slice slice_of(std::int64_t columns, const std::vector<double>& values) {
  Slice slice;
  slice.columns = {0, 0, 1, columns};
  slice.rows = {1, 0, 1, static_cast<std::int64_t>(values.size()) / columns};
  slice.values = values;
  return slice;
}

TEST(Contour, OfOneHighSampleIsARingAroundIt) {
  const Slice slice = slice_of(3, {0, 0, 0, 0, 4, 0, 0, 0, 0});
  const auto lines = contour_of(slice, 1);
  ASSERT_THAT(lines, SizeIs(1));
  EXPECT_TRUE(lines[0].closed);
  // Three quarters of the way from the sample to each neighbour.
  const std::vector<ContourPoint> expected = {{1, 0.25}, {0.25, 1}, {1, 1.75}, {1.75, 1}};
  EXPECT_THAT(lines[0].points, ::testing::UnorderedElementsAreArray(expected));
  EXPECT_EQ(points_of(lines), 4u);
}

TEST(Contour, OfAStepEndsAtBothEdges) {
  const Slice slice = slice_of(3, {0, 2, 2, 0, 2, 2, 0, 2, 2});
  const auto lines = contour_of(slice, 1);
  ASSERT_THAT(lines, SizeIs(1));
  EXPECT_FALSE(lines[0].closed);
  EXPECT_THAT(lines[0].points, ::testing::ElementsAre(ContourPoint{0.5, 0}, ContourPoint{0.5, 1},
                                                      ContourPoint{0.5, 2}));
  EXPECT_EQ(contour_path(lines, slice), "M10 25l0 -10l0 -10");
}

TEST(Contour, ARingIsClosedInThePath) {
  const Slice slice = slice_of(3, {0, 0, 0, 0, 2, 0, 0, 0, 0});
  const std::string path = contour_path(contour_of(slice, 1), slice);
  EXPECT_EQ(path.front(), 'M');
  EXPECT_EQ(path.back(), 'z');
  EXPECT_EQ(std::ranges::count(path, 'l'), 3);
}

TEST(Contour, TheMeanDecidesWhereCornersAcrossAreInside) {
  // Two high corners across: lines cut off the low ones where the mean is high.
  const auto across = [](double high) { return contour_of(slice_of(2, {high, 0, 0, high}), 1); };
  for (const double high : {1.5, 3.0}) {
    const auto lines = across(high);
    ASSERT_THAT(lines, SizeIs(2)) << high;
    // The line that begins on the lowest edge ends on the left one, around the corner at 0, 0, or on
    // the right one.
    EXPECT_EQ(lines[0].points.front().y, 0);
    EXPECT_EQ(lines[0].points.back().x, high > 2 ? 1 : 0) << high;
  }
}

TEST(Contour, TheSideDecidesWhereASampleHasTheIsovalue) {
  const Slice slice = slice_of(3, {0, 0, 0, 0, 1, 0, 0, 0, 0});
  EXPECT_THAT(contour_of(slice, 1), SizeIs(0));        // not above: outside, as its neighbours
  EXPECT_THAT(contour_of(slice, 1, true), SizeIs(1));  // not below, and they are
}

TEST(Contour, NanIsOutside) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto lines = contour_of(slice_of(3, {nan, nan, nan, nan, 2, nan, nan, nan, nan}), 1);
  ASSERT_THAT(lines, SizeIs(1));
  for (const ContourPoint& p : lines[0].points)
    EXPECT_TRUE(p.x == 0.5 || p.x == 1.5 || p.y == 0.5 || p.y == 1.5);
  EXPECT_THAT(contour_of(slice_of(2, {nan, nan, nan, nan}), 1), SizeIs(0));
}

TEST(Contour, NothingOfASliceOfOneRow) {
  EXPECT_THAT(contour_of(slice_of(3, {0, 2, 0}), 1), SizeIs(0));
}

// Of noise each crossed edge of the grid is a point of one line, and open lines end at the edge.
TEST(Contour, UsesEveryCrossedEdgeOnce) {
  std::mt19937 random(7);
  for (int round = 0; round < 50; ++round) {
    const std::int64_t columns = 2 + static_cast<std::int64_t>(random() % 9);
    const std::int64_t rows = 2 + static_cast<std::int64_t>(random() % 9);
    std::vector<double> values;
    for (std::int64_t i = 0; i < columns * rows; ++i)
      values.push_back(static_cast<double>(random() % 1000));
    const Slice slice = slice_of(columns, values);
    std::size_t crossed = 0;
    const auto high = [&](std::int64_t c, std::int64_t r) {
      return values[slice.place(c, r)] > 499.5;
    };
    for (std::int64_t r = 0; r < rows; ++r)
      for (std::int64_t c = 0; c < columns; ++c) {
        if (c + 1 < columns && high(c, r) != high(c + 1, r)) ++crossed;
        if (r + 1 < rows && high(c, r) != high(c, r + 1)) ++crossed;
      }
    const auto lines = contour_of(slice, 499.5);
    EXPECT_EQ(points_of(lines), crossed);
    const auto on_edge = [&](const ContourPoint& p) {
      return p.x == 0 || p.y == 0 || p.x == static_cast<double>(columns - 1) ||
             p.y == static_cast<double>(rows - 1);
    };
    for (const ContourLine& line : lines) {
      EXPECT_GT(line.points.size(), line.closed ? 3u : 1u);
      if (line.closed) continue;
      EXPECT_TRUE(on_edge(line.points.front()) && on_edge(line.points.back()));
    }
  }
}

}  // namespace
}  // namespace voxweld
