// The [labels] table: which labels are meshed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/config/settings.h"
#include "tests/pipeline/config/config_texts.h"

namespace voxweld {
namespace {

using testing::error_of;
using testing::least_config;
using testing::parse;

using Ranges = std::vector<LabelRange>;
using Select = LabelsConfig::Select;

LabelsConfig labels_of(const std::string& keys) {
  return parse(least_config("[labels]\nmode = \"each\"\n" + keys)).labels;
}

TEST(Labels, TakesEveryKey) {
  const LabelsConfig labels = labels_of(R"(
select = [3, "10-20", 1, 2, "15-30", "9223372036854775808", "18446744073709551614"]
background = ["0-1", 255]
map = "tables/brain.csv"
min_voxels = 10
max_voxels = 9223372036854775807
)");
  const std::uint64_t beyond = std::uint64_t{1} << 63;
  EXPECT_EQ(labels.select, Select::listed);
  EXPECT_EQ(labels.selected,
            (Ranges{{1, 3}, {10, 30}, {beyond, beyond}, {highest_label, highest_label}}));
  EXPECT_EQ(labels.background, (Ranges{{0, 1}, {255, 255}}));
  EXPECT_EQ(labels.map, "/data/tables/brain.csv");
  EXPECT_EQ(labels.min_voxels, 10);
  EXPECT_EQ(labels.max_voxels, std::numeric_limits<std::int64_t>::max());
}

TEST(Labels, ByDefaultAllButZero) {
  const LabelsConfig labels = labels_of("");
  EXPECT_EQ(labels.select, Select::all);
  EXPECT_EQ(labels.background, (Ranges{{0, 0}}));
  EXPECT_EQ(labels, labels_of("select = \"all\"\nbackground = [0]\nmin_voxels = 0\n"));
  EXPECT_TRUE(labels_of("background = []").background.empty());
}

TEST(Labels, OneWayToWriteThem) {
  EXPECT_EQ(labels_of("select = [1, 2, 3]"), labels_of("select = [\"2-3\", \"1-2\"]"));
  const Setting& select = *find_setting("labels", "select");
  const auto written = [&](const std::string& list) {
    return to_toml(*select.get(parse(least_config("labels.select = " + list))));
  };
  EXPECT_EQ(written("[7, 1, \"2\"]"), "[\"1-2\", 7]");
  EXPECT_EQ(written("[\"9223372036854775807\", \"18446744073709551614\"]"),
            "[9223372036854775807, \"18446744073709551614\"]");
  EXPECT_EQ(written("\"all\""), "\"all\"");
}

TEST(Labels, OnTheCommandLine) {
  const Config config = parse(least_config(), {"labels.select=mapped", "labels.map=a.csv",
                                               "labels.background=[0, \"7-9\"]"});
  EXPECT_EQ(config.labels.select, Select::mapped);
  EXPECT_EQ(config.labels.map, std::filesystem::current_path() / "a.csv");
  EXPECT_EQ(config.labels.background, (Ranges{{0, 0}, {7, 9}}));
}

TEST(Labels, EditsGiveLabelsToOneComplex) {
  const auto with = [](const std::string& mode, const std::string& keys) {
    return least_config("labels.mode = \"" + mode + "\"\n[[edit]]\nshape = \"sphere\"\n" +
                        "center = [4, 4, 4]\nradius = 2\n" + keys);
  };
  for (const char* mode : {"each", "shared"}) {
    const Config config = parse(with(mode, "op = \"replace\"\nmaterial = 7\n"));
    EXPECT_EQ(config.edits.at(0).op, EditOp::replace);
    EXPECT_EQ(config.edits.at(0).material, 7U);
    EXPECT_NO_THROW(parse(with(mode, "op = \"subtract\"\n")));
  }
  EXPECT_NO_THROW(
      parse("[input]\nformat = \"empty\"\nsize = [9, 9, 9]\n[labels]\nmode = \"each\"\n"
            "[[edit]]\nop = \"add\"\nmaterial = 7\nshape = \"sphere\"\ncenter = [4, 4, 4]\n"
            "radius = 2\n"));
  const auto refused = [&](const std::string& mode, const std::string& keys) {
    return error_of(with(mode, keys));
  };
  EXPECT_EQ(refused("shared", "op = \"add\"\n"),
            "/data/scan.toml: edit 1: material is missing: expected the label that the solid gets");
  EXPECT_EQ(refused("each", "op = \"replace\"\n"),
            "/data/scan.toml: edit 1: material is missing: expected the label that the solid gets");
  EXPECT_EQ(refused("off", "op = \"replace\"\nmaterial = 7\n"),
            "/data/scan.toml: edit 1: op = \"replace\": there is one material, so nothing to "
            "replace; it is for labels.mode = \"each\" and \"shared\"");
}

TEST(Labels, FormatsWithoutAPlaceForThemAreRefused) {
  EXPECT_EQ(
      error_of(
          least_config("[labels]\nmode = \"shared\"\n[output]\nformats = [\"ply\", \"stl\"]\n")),
      "/data/scan.toml:6:11: output.formats = [\"ply\", \"stl\"]: \"stl\" has no place for the "
      "labels that triangles of labels.mode = \"shared\" separate; remove it, or set "
      "labels.mode = \"each\"");
  const Config each = testing::parse(
      least_config("[labels]\nmode = \"each\"\n[output]\nformats = [\"obj\", \"stl\"]\n"));
  EXPECT_EQ(each.output.formats.size(), 2u);
}

TEST(Labels, WhatContradictsIsRefused) {
  EXPECT_EQ(error_of(least_config("[labels]\nselect = \"mapped\"\n")),
            "/data/scan.toml:4:10: labels.select = \"mapped\": there is no labels.map that names "
            "labels; give one, or a list");
  EXPECT_EQ(error_of(least_config("[labels]\nmax_voxels = 5\nmin_voxels = 6\n")),
            "/data/scan.toml:5:14: labels.min_voxels = 6: expected at most labels.max_voxels = 5; "
            "nothing would be left");
  EXPECT_EQ(error_of(least_config("labels.slect = [1]\n")),
            "/data/scan.toml:3:8: unknown key labels.slect; did you mean labels.select? [labels] "
            "takes mode, select, background, map, min_voxels, max_voxels");
}

}  // namespace
}  // namespace voxweld
