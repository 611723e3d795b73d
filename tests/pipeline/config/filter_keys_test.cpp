// What filters do to the keys of stages, and how their changes are told.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "tests/pipeline/config/config_texts.h"
#include "tests/pipeline/config/filter_texts.h"

namespace voxweld {
namespace {

using testing::filter_sample;
using testing::least_config;
using testing::parse;

// Every value another than the table's sample, and valid beside the other samples.
const std::map<std::string, std::string> other_filter_values = {{"type", ""},
                                                                {"clip", "[-1000.0, 2001.0]"},
                                                                {"scale", "[0.0, 254.0]"},
                                                                {"sigma", "[1.0, 1.0, 0.25]"},
                                                                {"radius", "[1, 1, 2]"},
                                                                {"factor", "[2, 2, 3]"},
                                                                {"method", "\"mode\""},
                                                                {"axes", "\"y\""},
                                                                {"order", "\"zxy\""},
                                                                {"path", "\"other.nrrd\""},
                                                                {"values", "[1, \"5-8\"]"},
                                                                {"outside", "1.0"},
                                                                {"min_voxels", "1001"},
                                                                {"max_voxels", "1001"},
                                                                {"inside", "254.0"},
                                                                {"sample_type", "\"int16\""}};

std::set<Stage> keys_changed(const Config& before, const Config& after) {
  std::set<Stage> stages;
  for (const Stage stage : all_stages)
    if (parameter_hash(before, stage) != parameter_hash(after, stage)) stages.insert(stage);
  return stages;
}

void expect_one_change(const std::string& key, const Config& before, const Config& after) {
  EXPECT_EQ(keys_changed(before, after), std::set{Stage::ingest}) << key;
  EXPECT_NE(config_fingerprint(before), config_fingerprint(after)) << key;
  EXPECT_NE(result_hash(before), result_hash(after)) << key;
  const auto changes = changed_settings(before, after);
  ASSERT_EQ(changes.size(), 1U) << key;
  EXPECT_EQ(changes[0].name, "filter 2: " + key);
  EXPECT_NE(changes[0].before, changes[0].after);
  for (const Stage stage : all_stages)
    EXPECT_EQ(changes[0].read_by(stage), stage == Stage::ingest) << key;
}

TEST(FilterKeys, EveryChangeIsToldAndChangesIngestsAlone) {
  ASSERT_EQ(other_filter_values.size(), filter_items().settings.size());
  for (const FilterType type : filter_items().kinds()) {
    for (const FilterSetting& setting : filter_items().settings) {
      const std::string& key = setting.key;
      if (!setting.taken_by(type) || key == "type") continue;
      // Other methods than the mean have no sample_type.
      std::map<std::string, std::string> base;
      if (key == "method") base["sample_type"] = "";
      const std::string first = filter_sample(type);
      const Config before = parse(least_config(first + filter_sample(type, base)));
      base[key] = other_filter_values.at(key);
      expect_one_change(key, before, parse(least_config(first + filter_sample(type, base))));
      if (setting.required || (type == FilterType::mask && key == "outside") || key == "method")
        continue;
      base[key] = "";  // left open or at its default
      if (key == "factor" || key == "radius" || !setting.default_value)
        expect_one_change(key, before, parse(least_config(first + filter_sample(type, base))));
    }
  }
}

TEST(FilterKeys, KnowOrderNumberAndType) {
  const auto key = [](const std::string& text) {
    return parameter_hash(parse(least_config(text)), Stage::ingest);
  };
  const std::string flip = filter_sample(FilterType::flip);
  const std::string mean = filter_sample(FilterType::mean, {{"sample_type", ""}});
  const std::string median = filter_sample(FilterType::median);
  EXPECT_NE(key(flip + mean), key(mean + flip));
  EXPECT_NE(key(flip), key(flip + flip));
  EXPECT_NE(key(mean), key(median));
  EXPECT_NE(key(""), key(flip));
  EXPECT_EQ(key(""), key("filter = []\n"));
  EXPECT_NE(config_fingerprint(parse(least_config(flip + mean))),
            config_fingerprint(parse(least_config(mean + flip))));
}

// Their keys are those of the time before there were filters.
TEST(FilterKeys, ConfigsWithoutKeepTheirs) {
  const Config config = parse(least_config());
  KeyHasher ingest;
  ingest.text("ingest");
  for (const StageParameter& parameter : stage_parameters(config, Stage::ingest)) {
    ingest.text(parameter.name).integer(parameter.value ? 1 : 0);
    if (parameter.value) feed(ingest, *parameter.value);
  }
  EXPECT_EQ(parameter_hash(config, Stage::ingest), ingest.finish());
  KeyHasher all;
  for (const Setting& setting : settings()) {
    const auto value = setting.get(config);
    all.text(setting.name()).integer(value ? 1 : 0);
    if (value) feed(all, *value);
  }
  EXPECT_EQ(config_fingerprint(config), all.finish());
}

// What is inside decides which pieces there are.
TEST(FilterKeys, PiecesAreKeyedByTheSurface) {
  const std::map<std::string, std::string> changes = {
      {"surface.isovalue", "6"}, {"surface.inside", "below"}, {"surface.border", "open"}};
  for (const FilterType type : filter_items().kinds()) {
    const Config before = parse(least_config(filter_sample(type)));
    const bool global = type == FilterType::keep || type == FilterType::fill;
    for (const auto& [name, value] : changes) {
      const Config after =
          parse(least_config(filter_sample(type)), {std::string(name).append("=").append(value)});
      const bool seen = global && name != "surface.border";
      EXPECT_EQ(keys_changed(before, after).contains(Stage::ingest), seen) << name;
      EXPECT_EQ(changed_settings(before, after).at(0).read_by(Stage::ingest), seen) << name;
      EXPECT_TRUE(changed_settings(before, after).at(0).read_by(Stage::build)) << name;
    }
  }
  const auto key = [](const std::string& rule) {
    return parameter_hash(
        parse(least_config(filter_sample(FilterType::keep)), {"surface.isovalue=" + rule}),
        Stage::ingest);
  };
  EXPECT_NE(key("otsu"), key("valley"));
  EXPECT_NE(key("otsu"), key("5"));
}

std::string told(const std::string& before, const std::string& after) {
  std::string text;
  for (const ChangedSetting& change :
       changed_settings(parse(least_config(before)), parse(least_config(after))))
    text += (text.empty() ? "" : ", ") + change.text();
  return text;
}

TEST(FilterKeys, ChangesAreToldShortly) {
  const auto mean = [](int radius) {
    return filter_sample(FilterType::mean,
                         {{"radius", std::to_string(radius)}, {"sample_type", ""}});
  };
  EXPECT_EQ(told("", mean(1)), "number of filters was 0, is 1");
  EXPECT_EQ(told(mean(1) + mean(1), mean(1) + mean(2)),
            "filter 2: radius was [1, 1, 1], is [2, 2, 2]");
  EXPECT_EQ(told(mean(1), filter_sample(FilterType::flip)),
            "filter 1: type was \"mean\", is \"flip\"");
  EXPECT_EQ(told(mean(1), "[[filter]]\ntype = \"mean\"\nsample_type = \"uint8\"\n"),
            "filter 1: sample_type was as it was, is \"uint8\"");
  EXPECT_EQ(told(mean(1) + mean(2), mean(2) + mean(1)), "filters 1, 2 changed");
}

}  // namespace
}  // namespace voxweld
