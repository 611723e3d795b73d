// The rules of a config against what its words say, label by label.
#include "pipeline/ingest/label_rules.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <map>
#include <set>

#include "pipeline/stage/artifacts.h"
#include "storage/support/error.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using Ranges = std::vector<LabelRange>;
using Select = LabelsConfig::Select;
using testing::TempDirectory;

bool in(const Ranges& ranges, std::uint64_t label) {
  return std::any_of(ranges.begin(), ranges.end(), [&](const LabelRange& range) {
    return range.first <= label && label <= range.last;
  });
}

const MaterialRange* entry_of(const LabelMap& map, std::uint64_t label) {
  for (const MaterialRange& entry : map.entries)
    if (entry.first <= label && label <= entry.last) return &entry;
  return nullptr;
}

Material meaning(const LabelsConfig& config, const LabelMap& map, std::uint64_t label) {
  const auto left_out = [&](std::uint64_t number) {
    const bool listed = config.select == Select::listed && in(config.selected, number);
    return in(config.background, number) && !listed;
  };
  const MaterialRange* entry = entry_of(map, label);
  if (config.select == Select::listed && !in(config.selected, label)) return exterior;
  if (config.select == Select::mapped && entry == nullptr) return exterior;
  if (left_out(label)) return exterior;
  if (entry == nullptr || entry->own) return label;
  return entry->material == exterior || left_out(entry->material) ? exterior : entry->material;
}

// Few labels, near both ends of what there is, so that everything touches everything.
constexpr std::uint64_t side = 24;
std::uint64_t label_at(std::uint64_t i) {
  return i < side ? i : highest_label - (2 * side - 1 - i);
}
std::vector<std::uint64_t> all_labels() {
  std::vector<std::uint64_t> labels = {1000, std::uint64_t{1} << 63};
  for (std::uint64_t i = 0; i < 2 * side; ++i) labels.push_back(label_at(i));
  return labels;
}

Ranges any_ranges() {
  Ranges ranges;
  const int count = *rc::gen::inRange(0, 4);
  std::uint64_t next = 0;
  for (int i = 0; i < count && next < 2 * side; ++i) {
    const auto first = next + *rc::gen::inRange<std::uint64_t>(0, 12);
    const auto last = std::min(2 * side - 1, first + *rc::gen::inRange<std::uint64_t>(0, 8));
    if (first > last) break;
    ranges.push_back({label_at(first), label_at(last)});
    next = last + 2;
  }
  return ranges;
}

LabelsConfig any_config() {
  LabelsConfig config;
  config.mode = LabelMode::each;
  config.background = any_ranges();
  config.select = *rc::gen::element(Select::all, Select::mapped, Select::listed);
  if (config.select == Select::listed) {
    config.selected = any_ranges();
    if (config.selected.empty()) config.selected = {{3, 5}};
  }
  return config;
}

LabelMap any_map() {
  LabelMap map;
  for (std::uint64_t i = 0; i < 2 * side;) {
    const auto length = *rc::gen::inRange<std::uint64_t>(1, 6);
    const auto last = std::min(2 * side - 1, i + length - 1);
    const auto material = label_at(*rc::gen::inRange<std::uint64_t>(0, 2 * side));
    // A range across the middle would name all there is between.
    const bool crosses = i < side && last >= side;
    switch (crosses ? 0 : *rc::gen::inRange(0, 5)) {
      case 1:
        map.entries.push_back({label_at(i), label_at(last), true, exterior});
        break;
      case 2:
        map.entries.push_back({label_at(i), label_at(last), false, exterior});
        break;
      case 3:
        map.entries.push_back({label_at(i), label_at(last), false, material});
        break;
      case 4:
        map.entries.push_back({label_at(i), label_at(i), false, label_at(i)});
        break;
      default:
        break;
    }
    i = last + 1;
  }
  return map;
}

RC_GTEST_PROP(LabelRules, AreWhatTheWordsSay, ()) {
  const LabelsConfig config = any_config();
  const LabelMap map = any_map();
  const MaterialRules rules = chosen_rules(config, map);
  for (const std::uint64_t label : all_labels())
    RC_ASSERT(rules.of(label) == meaning(config, map, label));
  for (std::size_t i = 0; i < rules.ranges.size(); ++i) {
    const MaterialRange& range = rules.ranges[i];
    RC_ASSERT(range.first <= range.last && range.last <= highest_label);
    RC_ASSERT(i == 0 || rules.ranges[i - 1].last < range.first);
  }
}

// Equal rules are equal objects, whatever they were made of: the same rules again from the table
// of every label.
RC_GTEST_PROP(LabelRules, HaveOneForm, ()) {
  const MaterialRules rules = chosen_rules(any_config(), any_map());
  LabelMap every;
  std::set<std::uint64_t> cuts = {0};
  for (const MaterialRange& range : rules.ranges) {
    cuts.insert({range.first, range.last + 1});
    if (range.material >= range.first && range.material <= range.last)
      cuts.insert({range.material, range.material + 1});
  }
  for (std::uint64_t i = 0; i < 2 * side; ++i) cuts.insert({label_at(i), label_at(i) + 1});
  for (auto cut = cuts.begin(); cut != cuts.end() && *cut <= highest_label; ++cut) {
    const auto next = std::next(cut);
    const std::uint64_t last = next == cuts.end() ? highest_label : *next - 1;
    const Material material = rules.of(*cut);
    every.entries.push_back({*cut, last, material == *cut, material == *cut ? exterior : material});
  }
  LabelsConfig config;
  config.background.clear();
  RC_ASSERT(chosen_rules(config, every) == rules);
  RC_ASSERT(hash_of(chosen_rules(config, every)) == hash_of(rules));
}

TEST(LabelRules, ByDefaultAllButZero) {
  const MaterialRules rules = chosen_rules(LabelsConfig{}, {});
  EXPECT_EQ(rules, (MaterialRules{{{0, 0, false, exterior}}, true}));
  EXPECT_NE(hash_of(rules), hash_of(MaterialRules{{{0, 0, false, exterior}}, false}));
  LabelsConfig some;
  some.select = Select::listed;
  some.selected = {{0, 3}};
  EXPECT_EQ(chosen_rules(some, {}), (MaterialRules{{{0, 3, true, exterior}}, false}))
      << "what is listed is no background";
}

// What cannot change which label stands for what leaves the rules as they are.
TEST(LabelRules, WhatHasNoSayChangesNothing) {
  LabelsConfig config;
  config.select = Select::listed;
  config.selected = {{1, 9}};
  const LabelMap map = parse_label_map("label,material,name\n3,5,a\n4,5,b\n70,5,c\n", "a.csv");
  const MaterialRules rules = chosen_rules(config, map);
  EXPECT_EQ(rules,
            chosen_rules(config, parse_label_map("label,material,name\n3,5,x\n4,5,\n", "a")));
  EXPECT_EQ(rules, chosen_rules(config, parse_label_map("label,material\n3-4,5\n5,5\n", "a")));
  config.background = {{0, 0}, {100, 200}};
  EXPECT_EQ(rules, chosen_rules(config, map));
  config.background = {{5, 5}};
  EXPECT_EQ(rules, chosen_rules(config, map)) << "5 is listed";
  config.selected = {{1, 4}};
  EXPECT_NE(rules, chosen_rules(config, map)) << "and now it is not";
}

// Counts of some labels, in a file.
class SizedRules : public ::testing::Test {
 protected:
  void write(const std::map<std::uint64_t, std::uint64_t>& voxels) {
    LabelCountsWriter out(directory_ / "labels.all", {});
    std::uint32_t at = 0;
    for (const auto& [label, count] : voxels) {
      out.add({label, count, {at, 0, 0}, {at + 2, 1, 1}});
      ++at;
    }
    out.commit(0);
    counts_ = std::make_unique<LabelCounts>(directory_ / "labels.all");
  }
  const LabelCounts& counts() const { return *counts_; }
  MaterialRules sized(const MaterialRules& chosen, std::int64_t least, std::int64_t most,
                      std::uint64_t memory = 1 << 20) const {
    LabelsConfig config;
    config.min_voxels = least;
    config.max_voxels = most;
    return sized_rules(config, chosen, counts(), memory);
  }
  std::map<Material, LabelCount> materials(const MaterialRules& rules) const {
    std::map<Material, LabelCount> found;
    Material before = 0;
    each_material(rules, counts(), [&](const LabelCount& count) {
      EXPECT_TRUE(found.empty() || count.label > before);
      before = count.label;
      found[count.label] = count;
      return true;
    });
    return found;
  }

 private:
  const TempDirectory directory_;
  std::unique_ptr<LabelCounts> counts_;
};

TEST_F(SizedRules, AreShort) {
  write({{0, 1000}, {3, 50}, {5, 60}, {9, 2}, {10, 3}, {12, 70}, {20, 1}, {21, 900}});
  const MaterialRules all = chosen_rules(LabelsConfig{}, {});
  EXPECT_EQ(
      sized(all, 10, 0),
      (MaterialRules{{{3, 5, true, exterior}, {12, 12, true, exterior}, {21, 21, true, exterior}},
                     false}));
  EXPECT_EQ(sized(all, 10, 100),
            (MaterialRules{{{3, 5, true, exterior}, {12, 12, true, exterior}}, false}));
  EXPECT_TRUE(sized(all, 1001, 0).ranges.empty());
  EXPECT_THROW(sized(all, 10, 0, 64), InputError);
}

TEST_F(SizedRules, JudgeWhatWasMerged) {
  write({{1, 4}, {2, 4}, {3, 4}, {7, 9}, {8, 10}});
  // 1, 3 and 7 become 7: 17 samples. 2 stays 2, 8 becomes 5.
  const MaterialRules merged =
      chosen_rules(LabelsConfig{}, parse_label_map("label,material\n1,7\n3,7\n8,5\n", "a.csv"));
  const MaterialRules rules = sized(merged, 11, 0);
  for (const std::uint64_t label : {1, 3, 7}) EXPECT_EQ(rules.of(label), 7U);
  for (const std::uint64_t label : {2, 8}) EXPECT_EQ(rules.of(label), exterior);
  const auto found = materials(merged);
  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found.at(7), (LabelCount{7, 17, {0, 0, 0}, {5, 1, 1}}));
  EXPECT_EQ(found.at(5).voxels, 10U);
  EXPECT_EQ(found.at(2).voxels, 4U);
  EXPECT_EQ(materials(rules).size(), 1U);
}

TEST_F(SizedRules, EachMaterialUntilThereAreEnough) {
  write({{1, 4}, {2, 4}, {3, 4}, {7, 9}});
  const MaterialRules merged =
      chosen_rules(LabelsConfig{},
                   parse_label_map("label,material\n1,9\n7,2\n3,18446744073709551614\n", "a.csv"));
  std::vector<Material> found;
  for (const std::size_t enough : {1, 2, 3, 4}) {
    found.clear();
    each_material(merged, counts(), [&](const LabelCount& count) {
      found.push_back(count.label);
      return found.size() < enough;
    });
    EXPECT_EQ(found.size(), std::min<std::size_t>(enough, 3));
  }
  EXPECT_EQ(found, (std::vector<Material>{2, 9, highest_label}));
}

RC_GTEST_PROP(LabelRules, OfSizesAreWhatTheWordsSay, ()) {
  const TempDirectory directory;
  const LabelsConfig config = [] {
    LabelsConfig any = any_config();
    any.min_voxels = *rc::gen::inRange<std::int64_t>(0, 12);
    any.max_voxels = *rc::gen::element<std::int64_t>(0, any.min_voxels, 12, 30);
    return any;
  }();
  const LabelMap map = any_map();
  const MaterialRules chosen = chosen_rules(config, map);
  std::map<std::uint64_t, std::uint64_t> voxels;
  for (const std::uint64_t label : all_labels())
    if (*rc::gen::arbitrary<bool>()) voxels[label] = *rc::gen::inRange<std::uint64_t>(1, 15);
  LabelCountsWriter out(directory / "labels.all", {});
  std::map<Material, std::uint64_t> sizes;
  for (const auto& [label, count] : voxels) {
    out.add({label, count, {0, 0, 0}, {1, 1, 1}});
    if (chosen.of(label) != exterior) sizes[chosen.of(label)] += count;
  }
  out.commit(0);
  const LabelCounts counts(directory / "labels.all");
  const MaterialRules rules = sized_rules(config, chosen, counts, 1 << 20);
  std::map<Material, std::uint64_t> left = sizes;
  std::erase_if(left, [&](const auto& material) {
    const auto size = static_cast<std::int64_t>(material.second);
    return size < config.min_voxels || (config.max_voxels != 0 && size > config.max_voxels);
  });
  for (const auto& [label, count] : voxels) {
    const Material material = chosen.of(label);
    RC_ASSERT(rules.of(label) == (left.contains(material) ? material : exterior));
  }
  for (const auto& [of, expected] : {std::pair{chosen, sizes}, std::pair{rules, left}}) {
    std::map<Material, std::uint64_t> found;
    each_material(of, counts, [&](const LabelCount& count) {
      found[count.label] = count.voxels;
      return true;
    });
    RC_ASSERT(found == expected);
  }
}

TEST(LabelRules, BackgroundThatTheMapMeans) {
  const LabelMap map = parse_label_map("label,material\n0,7\n1,\n2,2\n3,0\n4-6,9\n", "a.csv");
  LabelsConfig config;
  EXPECT_EQ(background_in_map(config, map), "0");
  config.background = {{0, 5}};
  EXPECT_EQ(background_in_map(config, map), "0, 4");
  config.background = {{1, 3}};
  EXPECT_EQ(background_in_map(config, map), "3");
  config.background = {};
  EXPECT_EQ(background_in_map(config, map), "");
}

}  // namespace
}  // namespace voxweld
