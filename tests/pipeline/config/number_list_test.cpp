#include "pipeline/config/number_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/config/settings.h"
#include "tests/pipeline/config/config_texts.h"

namespace voxweld {
namespace {

using testing::error_of;
using testing::least_config;
using testing::parse;

TEST(NumberList, HasSeveralSyntaxes) {
  const ConfigValue::List expected = {{std::int64_t{1}}, {std::int64_t{2}}, {2.5}};
  for (const char* text : {"1,2,2.5", "1 2 2.5", "1, 2, 2.5", "[1, 2, 2.5]", "[1 2 2.5]", "1x2x2.5",
                           "1 x 2 x 2.5", "[1x2x2.5]", " 1\t2 2.5 "})
    EXPECT_EQ(parse_number_list(text), expected) << text;
  const ConfigValue::List negative = {{std::int64_t{-1}}, {-1e-3}};
  for (const char* text : {"-1,-1e-3", "-1 -1e-3"}) EXPECT_EQ(parse_number_list(text), negative);
}

TEST(NumberList, IsNothingElse) {
  for (const char* text : {"", "[]", ",", "1,,2", "1,2,", "a", "1,b", "1;2", "[1,2", "1 2]", "x"})
    EXPECT_EQ(parse_number_list(text), std::nullopt) << text;
}

// How --set takes them; TOML alone did before.
TEST(NumberList, IsTakenByEveryKeyThatHoldsOne) {
  for (const char* crop : {"[0,0,0,9,8,7]", "0,0,0,9,8,7", "0 0 0 9 8 7", "[0 0 0 9 8 7]"})
    EXPECT_EQ(parse(least_config(), {std::string("input.crop=") + crop}).input.crop,
              (Box3{{0, 0, 0}, {9, 8, 7}}))
        << crop;
  for (const char* spacing : {"[1, 2, 0.5]", "1,2,0.5", "1 2 0.5", "1x2x0.5"})
    EXPECT_EQ(parse(least_config(), {std::string("input.spacing=") + spacing}).input.spacing,
              (Vec3{1, 2, 0.5}))
        << spacing;
  const std::vector<std::string> labels = {"labels.mode=each", "labels.select=1, 5,10-20"};
  EXPECT_EQ(parse(least_config(), labels).labels.selected.size(), 3U);
  EXPECT_THAT(error_of(least_config(), {"input.spacing=1,2"}),
              ::testing::HasSubstr("input.spacing: expected a finite number above 0, or three of "
                                   "them: [x, y, z] (default: as the file says, else 1), found "
                                   "[1, 2] (a list of 2)"));
  // Where one number is meant a list is none.
  EXPECT_THAT(error_of(least_config(), {"work.brick=32,32"}),
              ::testing::HasSubstr("found \"32,32\" (a string)"));
}

TEST(NumberList, OneNumberNeedsNoZeroBesideItsPoint) {
  for (const char* tolerance : {".5", "0.5", "5.e-1", ".5e0"})
    EXPECT_EQ(
        parse(least_config(), {std::string("simplify.tolerance=") + tolerance}).simplify.tolerance,
        0.5)
        << tolerance;
  EXPECT_EQ(parse(least_config(), {"surface.isovalue=-.25"}).surface.isovalue, -0.25);
  EXPECT_EQ(parse(least_config(), {"surface.isovalue=3."}).surface.isovalue, 3);
  for (const char* other : {"\".5\"", "-.5", "1.2.3", "."})
    EXPECT_THAT(error_of(least_config(), {std::string("simplify.tolerance=") + other}),
                ::testing::HasSubstr("expected a finite number above 0"))
        << other;
  // Nor where a whole number is meant.
  EXPECT_THAT(error_of(least_config(), {"run.threads=2."}),
              ::testing::HasSubstr("found \"2.\" (a string)"));
}

}  // namespace
}  // namespace voxweld
