// Which tolerance leaves so many triangles.
#include "stages/refine/threshold.h"

#include <gtest/gtest.h>

#include "stages/refine/cube_lattice.h"

namespace voxweld::testing {
namespace {

TEST(Threshold, TolerancesAscendFromAThousandthOfACell) {
  const auto tried = survey_tolerances(100);
  EXPECT_DOUBLE_EQ(tried.front(), 100.0 / 1024);
  EXPECT_DOUBLE_EQ(tried.back(), 6400);
  for (std::size_t i = 1; i < tried.size(); ++i) {
    EXPECT_GT(tried[i], 1.4 * tried[i - 1]);
    EXPECT_LE(tried[i], 2 * tried[i - 1]);
  }
}

TEST(Threshold, TheSecondIsLookedForAroundTheFirst) {
  EXPECT_TRUE(recount_tolerances(0, 100).empty());
  const auto tried = recount_tolerances(10, 100);
  EXPECT_DOUBLE_EQ(tried.front(), 10.0 / 8);
  EXPECT_DOUBLE_EQ(tried.back(), 80);
  EXPECT_TRUE(std::ranges::find(tried, 10.0) != tried.end());
  EXPECT_TRUE(std::ranges::is_sorted(tried));
  EXPECT_DOUBLE_EQ(recount_tolerances(6400, 100).back(), 6400);  // no further than 64 cells
}

CollapseSurvey recount(std::vector<std::uint64_t> left) {
  CollapseSurvey survey;
  survey.inside = 900;
  survey.fixed = 100;
  survey.left = std::move(left);
  return survey;
}

TEST(Threshold, LiesBetweenTwoThatWereTried) {
  const std::vector<double> tried = {1, 2, 4};
  const CollapseSurvey survey = recount({700, 300, 100});
  EXPECT_EQ(second_threshold(survey, tried, 400), (CollapseThreshold{2, 400, true}));
  EXPECT_EQ(second_threshold(survey, tried, 600), (CollapseThreshold{1.5, 600, true}));
  EXPECT_EQ(second_threshold(survey, tried, 900), (CollapseThreshold{0.5, 900, true}));
  // To a sixteenth, and rather fewer.
  EXPECT_EQ(second_threshold(survey, tried, 598), (CollapseThreshold{1.5625, 575, true}));
  EXPECT_EQ(second_threshold(survey, tried, 576), (CollapseThreshold{1.5625, 575, true}));
}

TEST(Threshold, IsNoneWhereThereAreNoMore) {
  EXPECT_EQ(second_threshold(recount({700, 300}), {1, 2}, 1000),
            (CollapseThreshold{0, 1000, true}));
  EXPECT_EQ(second_threshold(recount({}), {}, 2000), (CollapseThreshold{0, 1000, true}));
}

TEST(Threshold, GoesNoFurtherThanIsOfUse) {
  EXPECT_EQ(second_threshold(recount({700, 301, 300}), {1, 2, 4}, 50),
            (CollapseThreshold{2, 401, false}));
}

// A square of 101 x 101 cells whose border stays, as it is when the border gets coarser too.
TEST(Threshold, OfTheFirstPassTakesTheBorderForCoarserThanItIs) {
  CollapseSurvey survey;
  survey.inside = std::uint64_t{2} * 101 * 101;
  survey.border = 404;
  // Ten times longer triangles: 200 or so, and one for each vertex of the border but 40.
  survey.left = {survey.inside, 204 + 364};
  const CollapseThreshold found = first_threshold(survey, {1, 2}, 210);
  EXPECT_TRUE(found.reached);
  EXPECT_GT(found.tolerance, 1.9);
}

TEST(CubeLevel, GrowsWhereFewTrianglesAreAskedFor) {
  const Index3 size{512, 512, 512};
  EXPECT_EQ(target_cube_level(1, 1000, size), 6);
  EXPECT_EQ(target_cube_level(0.3, 1000, size), 6);
  EXPECT_EQ(target_cube_level(0.1, 1000, size), 7);
  EXPECT_EQ(target_cube_level(0.02, 1000, size), 8);
  EXPECT_EQ(target_cube_level(1e-9, 1000, size), 8);
  EXPECT_EQ(target_cube_level(0.02, 8'000'000, size), 7);   // 64 cubes
  EXPECT_EQ(target_cube_level(0.02, 40'000'000, size), 6);  // more than one of 128 cells takes
}

}  // namespace
}  // namespace voxweld::testing
