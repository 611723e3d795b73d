// Filters that are wrong: the message names the place, the filter, the key, what is accepted and
// what was found.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "tests/pipeline/config/config_texts.h"
#include "tests/pipeline/config/filter_texts.h"
#include "tests/pipeline/config/wrong_items.h"

namespace voxweld {
namespace {

using testing::error_of;
using testing::filter_sample;
using testing::least_config;
using testing::WrongKey;

// Of a key its type comes first.
const std::vector<WrongKey> wrong_filter_keys = testing::read_wrong_keys(R"table(
window type: "window", "gaussian", "mean", "median", "downsample", "flip", "permute", "mask", \
"keep" or "fill"
  "gausian" (a string); did you mean "gaussian"? | "blur" (a string) | 3 | ["mean"] (a list of 1)
window clip: two finite numbers, the lower first: [lo, hi]
  [2, 1] (a list of 2) | [1, 1.0] (a list of 2) | 3 | [1] (a list of 1) | [1, 2, 3] (a list of 3)
  [1, inf] (a list of 2) | [nan, 2] (a list of 2) | [1, "2"] (a list of 2) | "1 2" (a string)
  [-1e+308, 1e+308] (a list of 2); they are too far apart
window scale: two finite numbers that are not equal: [a, b] (default: nowhere else)
  [1, 1.0] (a list of 2) | [0.0, -0.0] (a list of 2) | 3 | [1] (a list of 1) | true (a boolean)
gaussian sigma: a number above 0, at most 50, or three from 0 to 50, not all 0: [x, y, z]
  0 | 0.0 | -1 | 51 | 50.5 | inf | nan | [0, 0, 0.0] (a list of 3) | [1, 1, -1] (a list of 3)
  [1, 1] (a list of 2) | [1, 1, 50.5] (a list of 3) | "2" (a string); write numbers without quotes
mean radius: an integer above 0, at most 50, or three from 0 to 50, not all 0: [x, y, z] \
(default: [1, 1, 1])
median radius: an integer above 0, at most 50, or three from 0 to 50, not all 0: [x, y, z] \
(default: [1, 1, 1])
  0 | -1 | 51 | 1.0 | [0, 0, 0] (a list of 3) | [1, 1, 1.5] (a list of 3) | [1, 1] (a list of 2)
  [1, 51, 1] (a list of 3) | [-1, 1, 1] (a list of 3) | "1" (a string); write numbers without quotes
downsample factor: an integer above 1, at most 64, or three from 1 to 64, not all 1: \
[x, y, z] (default: [2, 2, 2])
  1 | 0 | 1025 | 2.0 | [1, 1, 1] (a list of 3) | [0, 2, 2] (a list of 3) | [2, 2] (a list of 2)
  [2, 1025, 2] (a list of 3)
downsample method: "mean", "max" or "mode" (default: "mean")
  "man" (a string); did you mean "mean"? | "median" (a string); did you mean "mean"? | 2
flip axes: the letters of axes, each once: "x", "yz", "xyz"
  "" (a string) | "xx" (a string); x is listed twice | "X" (a string) | "xw" (a string) | 1
  ["x"] (a list of 1) | "x y" (a string)
permute order: "xzy", "yxz", "yzx", "zxy" or "zyx"
  "zy" (a string); did you mean "xzy"? | 210 | [2, 1, 0] (a list of 3)
mask path: a path in quotes
  "" (a string) | 3; write paths in quotes
mask values: a list of labels and ranges such as [1, 5, "10-20"] (default: all but 0)
  [] (a list of 0) | 3; write it in brackets: [3] | "all" (a string)
  ["9-5"] (a list of 1); the lower end comes first: "5-9" | [-1] (a list of 1); found -1 in it
mask outside: a finite number (default: of a mask: required, but 0 where labels are meshed; of \
keep: the least sample where inside is above, else the greatest)
keep outside: a finite number (default: of a mask: required, but 0 where labels are meshed; of \
keep: the least sample where inside is above, else the greatest)
fill inside: a finite number (default: the greatest sample where inside is above, else the least)
  inf | nan | "0" (a string); write numbers without quotes | [0] (a list of 1) | true (a boolean)
  9007199254740993
keep min_voxels: an integer of at least 1 (default: the largest piece alone)
fill max_voxels: an integer of at least 1
  0 | -1 | 1.5 | [1] (a list of 1) | "10" (a string); write numbers without quotes
gaussian sample_type: "uint8", "int8", "uint16", "int16", "uint32", "int32", "uint64", "int64", \
"float32" or "float64" (default: as it was)
  "byte" (a string) | "unit8" (a string); did you mean "uint8"? | 8
)table");

const std::string mean_text = "[[filter]]\ntype = \"mean\"\nradius = 2\n";  // lines 3 to 5

TEST(FilterError, CoversEveryKey) {
  std::set<std::string> covered;
  for (const WrongKey& key : wrong_filter_keys) covered.insert(testing::split(key.name, " ")[1]);
  EXPECT_EQ(covered.size(), filter_items().settings.size());
}

TEST(FilterError, NamesPlaceFilterKeyExpectedAndFound) {
  testing::expect_values_refused(wrong_filter_keys, {"filter", "type", mean_text, 7});
}

TEST(FilterError, UnknownKeys) {
  EXPECT_EQ(error_of(least_config(mean_text + "radios = 3\n")),
            "/data/scan.toml:6:1: filter 1: unknown key radios; did you mean radius? A mean filter "
            "takes type, radius, sample_type");
  EXPECT_EQ(error_of(least_config("[[filter]]\ncolor = 3\n")),
            "/data/scan.toml:4:1: filter 1: unknown key color. A filter takes type, clip, scale, "
            "sigma, radius, factor, method, axes, order, path, values, outside, min_voxels, "
            "max_voxels, inside, sample_type");
}

TEST(FilterError, KeysOfOtherTypes) {
  EXPECT_EQ(error_of(least_config("[[filter]]\nsample_type = \"uint8\"\ntype = \"median\"\n")),
            "/data/scan.toml:4:1: filter 1: a median filter has no sample_type. A median filter "
            "takes type, radius");
  for (const FilterType type : filter_items().kinds())
    for (const FilterSetting& setting : filter_items().settings) {
      if (setting.taken_by(type)) continue;
      const std::string& name = filter_items().kind_name(type);
      EXPECT_THAT(
          error_of(least_config(filter_sample(type) + setting.key + " = " + setting.sample + "\n")),
          ::testing::HasSubstr(
              fmt::format(":1: filter 1: a {} filter has no {}. ", name, setting.key)));
    }
}

TEST(FilterError, MissingKeys) {
  EXPECT_THAT(error_of(least_config(mean_text + "[[filter]]\nradius = 1\n")),
              ::testing::StartsWith("/data/scan.toml:6:1: filter 2: missing key type (expected "
                                    "\"window\", \"gaussian\", "));
  std::set<std::string> missed;
  for (const FilterType type : filter_items().kinds())
    for (const FilterSetting& missing : filter_items().settings) {
      if (!missing.required_by(type) || missing.key == "type") continue;
      missed.insert(missing.key);
      EXPECT_EQ(error_of(least_config(filter_sample(type, {{missing.key, ""}}))),
                fmt::format("/data/scan.toml:3:1: filter 1: missing key {} (expected {}): {}",
                            missing.key, accepted_text(missing.rule), missing.description));
    }
  EXPECT_EQ(missed,
            (std::set<std::string>{"clip", "sigma", "axes", "order", "path", "max_voxels"}));
}

TEST(FilterError, AMaskSaysWhatIsOutside) {
  EXPECT_EQ(error_of(least_config(mean_text + "[[filter]]\ntype = \"mask\"\npath = \"m.nrrd\"\n")),
            "/data/scan.toml:6:1: filter 2: missing key outside: expected the real value that "
            "samples outside the mask get, a finite number");
}

TEST(FilterError, MediansAreSmall) {
  EXPECT_EQ(error_of(least_config("[[filter]]\nradius = [1, 11, 1]\ntype = \"median\"\n")),
            "/data/scan.toml:4:10: filter 1: radius: expected at most 10 of a median, found [1, "
            "11, 1]");
  testing::parse(least_config("[[filter]]\nradius = 10\ntype = \"median\"\n"));
}

TEST(FilterError, SamplesThatAreChosenKeepTheirType) {
  for (const char* method : {"max", "mode"})
    EXPECT_EQ(error_of(least_config(fmt::format("[[filter]]\ntype = \"downsample\"\nmethod = "
                                                "\"{}\"\nsample_type = \"uint8\"\n",
                                                method))),
              fmt::format("/data/scan.toml:6:15: filter 1: sample_type = \"uint8\": with method = "
                          "\"{}\" samples keep their type; remove it",
                          method));
}

TEST(FilterError, LabelsAreMadeOfLabels) {
  const std::map<FilterType, std::string> refused = {
      {FilterType::window, "type = \"window\""},
      {FilterType::gaussian, "type = \"gaussian\""},
      {FilterType::mean, "type = \"mean\""},
      {FilterType::median, "type = \"median\""},
      {FilterType::downsample, "type = \"downsample\" with method = \"mean\""},
      {FilterType::keep, "type = \"keep\""},
      {FilterType::fill, "type = \"fill\""}};
  const std::string flip = filter_sample(FilterType::flip);  // lines 4 to 6
  for (const char* labels :
       {"labels.mode = \"each\"\n", "labels.mode = \"shared\"\n", "surface.label = 5\n"})
    for (const auto& [type, text] : refused)
      EXPECT_EQ(error_of(least_config(labels + flip + filter_sample(type))),
                "/data/scan.toml:7:1: filter 2: " + text +
                    " makes no labels of labels; between labels and with surface.label take "
                    "downsample with method = \"mode\", flip, permute or mask");
  EXPECT_THAT(error_of(least_config("[[filter]]\ntype = \"downsample\"\nmethod = \"max\"\n"),
                       {"labels.mode=each"}),
              ::testing::StartsWith("/data/scan.toml:3:1: filter 1: type = \"downsample\" with "
                                    "method = \"max\" makes no labels"));
}

TEST(FilterError, OnlySamplesAreFiltered) {
  const std::string flip = filter_sample(FilterType::flip);
  EXPECT_EQ(error_of("input.path = \"part.stl\"\ninput.resolution = 50\n" + flip),
            "/data/scan.toml:3:1: filter 1: a mesh has no samples to filter; remove it");
  EXPECT_EQ(error_of("input.format = \"empty\"\ninput.size = [9, 9, 9]\n" + flip +
                     "[[edit]]\nshape = \"sphere\"\ncenter = [4, 4, 4]\nradius = 2\n"),
            "/data/scan.toml:3:1: filter 1: empty space has no samples to filter; remove it");
}

TEST(FilterError, OneTableIsNoFilter) {
  const std::string advice =
      "found a single table [filter]; write [[filter]], which may stand any number of times";
  EXPECT_EQ(error_of(least_config("[filter]\ntype = \"keep\"\n")),
            "/data/scan.toml:3:2: " + advice);
  EXPECT_EQ(error_of(least_config("filter.type = \"keep\"\n")), "/data/scan.toml:3:1: " + advice);
  EXPECT_THAT(error_of(least_config("filter = 3\n")),
              ::testing::StartsWith(
                  "/data/scan.toml:3:1: expected tables [[filter]] with keys type, clip, "));
  EXPECT_THAT(
      error_of(least_config("[[filters]]\ntype = \"keep\"\n")),
      ::testing::StartsWith(
          "/data/scan.toml:3:1: unknown table [[filters]]; did you mean [[filter]]? The tables "));
}

TEST(FilterError, OverridesDoNotNameFilters) {
  for (const char* option : {"filter.sigma=3", "filter[1].sigma=3", "filter = []", "filter",
                             " filter.1.type = \"mean\"", "filters=3"})
    EXPECT_EQ(error_of(least_config(mean_text), {option}),
              std::string("--set ") +
                  toml_string(option).substr(1, toml_string(option).size() - 2) +
                  ": filters are written in the config file only, as [[filter]] tables");
}

// Whatever the bytes, the answer is a config or one InputError.
TEST(FilterError, SurvivesDamagedText) {
  const std::string whole =
      least_config(filter_sample(FilterType::window) + filter_sample(FilterType::mask) +
                   filter_sample(FilterType::permute));
  const auto attempt = [](const std::string& text) {
    try {
      testing::parse(text);
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), ::testing::HasSubstr("/data/scan.toml"));
    }
  };
  for (std::size_t at = 0; at < whole.size(); ++at) {
    attempt(whole.substr(0, at));
    for (const char c : {'\0', '\n', '"', '[', ']', '\xff', '.', '=', '{'}) {
      std::string text = whole;
      text[at] = c;
      attempt(text);
    }
  }
}

}  // namespace
}  // namespace voxweld
