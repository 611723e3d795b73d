// Integers beyond what doubles and TOML hold: isovalues and labels of 64-bit samples.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/config/settings.h"
#include "tests/pipeline/config/config_texts.h"

namespace voxweld {
namespace {

using testing::error_of;
using ::testing::HasSubstr;
using testing::least_config;
using testing::parse;

void expect_kept(const Config& config, const std::string& line) {
  const std::string text = canonical_toml(config);
  EXPECT_THAT(text, HasSubstr("\n" + line + "\n"));
  EXPECT_EQ(parse(text), config);
}

TEST(LargeInteger, IsovaluesBeyond2To53AreKept) {
  const Config config = parse(least_config(), {"surface.isovalue=9007199254740993"});
  EXPECT_EQ(config.surface.isovalue, Isovalue::of(std::int64_t{9007199254740993}));
  expect_kept(config, "isovalue = 9007199254740993");
  expect_kept(parse(least_config(), {"surface.isovalue=-9223372036854775807"}),
              "isovalue = -9223372036854775807");
  const Config beside = parse(least_config(), {"surface.isovalue=9007199254740994"});
  EXPECT_NE(parameter_hash(config, Stage::build), parameter_hash(beside, Stage::build));
  EXPECT_EQ(
      parameter_hash(beside, Stage::build),
      parameter_hash(parse(least_config(), {"surface.isovalue=9007199254740994.0"}), Stage::build));
}

TEST(LargeInteger, IsovaluesBeyond2To63AreWrittenInQuotes) {
  const std::string line = "isovalue = \"18446744073709551615\"";
  const Config config = parse("input.path = \"a.nrrd\"\nsurface." + line + "\n");
  EXPECT_EQ(config.surface.isovalue, Isovalue::of(~std::uint64_t{0}));
  expect_kept(config, line);
  EXPECT_EQ(parse(least_config(), {"surface.isovalue=18446744073709551615"}).surface,
            config.surface);
  EXPECT_THAT(error_of(least_config(), {"surface.isovalue=\"120\""}),
              HasSubstr("write numbers without quotes"));
  EXPECT_THAT(error_of("input.path = \"a.nrrd\"\nsurface.isovalue = 18446744073709551615\n"),
              HasSubstr(":2:"));
}

TEST(LargeInteger, LabelsBeyond2To63AreWrittenInQuotes) {
  const std::string line = "label = \"9223372036854775809\"";
  const Config config = parse("input.path = \"a.nrrd\"\nsurface." + line + "\n");
  EXPECT_EQ(config.surface.label, 9223372036854775809U);
  expect_kept(config, line);
  EXPECT_EQ(parse("input.path = \"a.nrrd\"\n", {"surface.label=9223372036854775809"}).surface,
            config.surface);
  EXPECT_EQ(parse("input.path = \"a.nrrd\"\nsurface.label = \"7\"\n").surface,
            parse("input.path = \"a.nrrd\"\nsurface.label = 7\n").surface);
  EXPECT_THAT(error_of("input.path = \"a.nrrd\"\nsurface.label = \"18446744073709551615\"\n"),
              HasSubstr("labels end at 18446744073709551614"));
}

TEST(LargeInteger, MaterialsOfEditsBeyond2To63AreWrittenInQuotes) {
  const Config config = parse(
      "input.path = \"a.nrrd\"\nlabels.mode = \"each\"\n[[edit]]\nop = \"add\"\nshape = "
      "\"sphere\"\ncenter = [1, 2, 3]\nradius = 2\nmaterial = \"9223372036854775808\"\n");
  EXPECT_EQ(config.edits.at(0).material, 9223372036854775808U);
  expect_kept(config, "material = \"9223372036854775808\"");
}

}  // namespace
}  // namespace voxweld
