#include "pipeline/ingest/label_rules.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "pipeline/executor/memory_budget.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

using Ranges = std::vector<LabelRange>;  // ascending, apart

bool contains(const Ranges& ranges, std::uint64_t label) {
  const auto after = std::upper_bound(
      ranges.begin(), ranges.end(), label,
      [](std::uint64_t value, const LabelRange& range) { return value < range.first; });
  return after != ranges.begin() && label <= (after - 1)->last;
}

// The labels that are in none of the ranges.
Ranges complement(const Ranges& ranges) {
  Ranges rest;
  std::uint64_t next = 0;
  for (const LabelRange& range : ranges) {
    if (range.first > next) rest.push_back({next, range.first - 1});
    next = range.last + 1;
  }
  if (next <= highest_label) rest.push_back({next, highest_label});
  return rest;
}

Ranges common(const Ranges& a, const Ranges& b) {
  Ranges both;
  for (std::size_t i = 0, k = 0; i < a.size() && k < b.size();) {
    const LabelRange overlap{std::max(a[i].first, b[k].first), std::min(a[i].last, b[k].last)};
    if (overlap.first <= overlap.last) both.push_back(overlap);
    ++(a[i].last < b[k].last ? i : k);
  }
  return both;
}

Ranges mapped(const LabelMap& map) {
  Ranges ranges;
  for (const MaterialRange& entry : map.entries) {
    if (!ranges.empty() && ranges.back().last + 1 == entry.first)
      ranges.back().last = entry.last;
    else
      ranges.push_back({entry.first, entry.last});
  }
  return ranges;
}

// What is left out whatever the map makes of it.
Ranges background(const LabelsConfig& config) {
  if (config.select != LabelsConfig::Select::listed) return config.background;
  return common(config.background, complement(config.selected));
}

Ranges taken(const LabelsConfig& config, const LabelMap& map) {
  using Select = LabelsConfig::Select;
  if (config.select == Select::listed) return config.selected;
  const Ranges rest = complement(config.background);
  return config.select == Select::all ? rest : common(mapped(map), rest);
}

// Ranges that become materials, in ascending order; a label in none is left out.
class RuleBuilder {
 public:
  // touching: only ranges without a label between them are joined.
  explicit RuleBuilder(bool touching) : touching_(touching) {}

  void add(std::uint64_t first, std::uint64_t last, const MaterialRange& meaning) {
    if (meaning.own) return append({first, last, true, exterior});
    const Material material = meaning.material;
    if (material == exterior) return leave_out();
    if (material < first || material > last) return append({first, last, false, material});
    if (first < material) append({first, material - 1, false, material});
    append({material, material, true, exterior});
    if (material < last) append({material + 1, last, false, material});
  }
  // There is a label behind the last range that is left out.
  void leave_out() { open_ = false; }

  // Precondition: touching.
  MaterialRules finish() && {
    const bool others =
        !ranges_.empty() && ranges_.back().own && ranges_.back().last == highest_label;
    MaterialRules rules{{}, others};
    if (!others) {
      rules.ranges = std::move(ranges_);
      return rules;
    }
    std::uint64_t next = 0;
    for (const MaterialRange& range : ranges_) {
      if (range.first > next) rules.ranges.push_back({next, range.first - 1, false, exterior});
      if (!range.own) rules.ranges.push_back(range);
      next = range.last + 1;
    }
    return rules;
  }
  std::vector<MaterialRange> ranges() && { return std::move(ranges_); }
  std::uint64_t count() const { return count_; }
  // Only counts from now on.
  void keep_nothing() { keep_ = false; }

 private:
  void append(const MaterialRange& range) {
    const bool same = count_ > 0 && last_.own == range.own && last_.material == range.material;
    const bool joined = same && (touching_ ? last_.last + 1 == range.first : open_);
    open_ = true;
    if (joined) {
      last_.last = range.last;
      if (keep_) ranges_.back().last = range.last;
      return;
    }
    last_ = range;
    ++count_;
    if (keep_) ranges_.push_back(range);
  }

  const bool touching_;
  bool keep_ = true, open_ = false;
  std::uint64_t count_ = 0;
  MaterialRange last_;
  std::vector<MaterialRange> ranges_;
};

// Of the materials that several labels may become, each with what they have together.
std::map<Material, LabelCount> merged_counts(const MaterialRules& rules,
                                             const LabelCounts& counts) {
  std::map<Material, LabelCount> merged;
  for (const MaterialRange& range : rules.ranges)
    if (!range.own && range.material != exterior) merged.try_emplace(range.material);
  if (merged.empty()) return merged;
  counts.each([&](const LabelCount& count) {
    const Material material = rules.of(count.label);
    const auto found = material == exterior ? merged.end() : merged.find(material);
    if (found == merged.end()) return true;
    LabelCount part = count;
    part.label = material;
    if (found->second.voxels == 0)
      found->second = part;
    else
      add(found->second, part);
    return true;
  });
  return merged;
}

}  // namespace

MaterialRules chosen_rules(const LabelsConfig& config, const LabelMap& map) {
  const Ranges left_out = background(config);
  RuleBuilder builder(true);
  auto entry = map.entries.begin();
  const MaterialRange itself{0, 0, true, exterior};
  for (const LabelRange& range : taken(config, map)) {
    std::uint64_t next = range.first;
    while (entry != map.entries.end() && entry->last < range.first) ++entry;
    for (; entry != map.entries.end() && entry->first <= range.last; ++entry) {
      if (entry->first > next) builder.add(next, entry->first - 1, itself);
      const std::uint64_t first = std::max(entry->first, range.first);
      const std::uint64_t last = std::min(entry->last, range.last);
      const bool gone = !entry->own && contains(left_out, entry->material);
      if (!gone) builder.add(first, last, *entry);
      next = last + 1;
      if (entry->last > range.last) break;  // the next range may have more of it
    }
    if (next <= range.last) builder.add(next, range.last, itself);
  }
  return std::move(builder).finish();
}

bool asks_for_sizes(const LabelsConfig& config) {
  return config.min_voxels > 0 || config.max_voxels > 0;
}

MaterialRules sized_rules(const LabelsConfig& config, const MaterialRules& chosen,
                          const LabelCounts& counts, std::uint64_t memory) {
  const auto merged = merged_counts(chosen, counts);
  const auto least = static_cast<std::uint64_t>(config.min_voxels);
  const auto most = static_cast<std::uint64_t>(config.max_voxels);
  const auto build = [&](RuleBuilder& builder) {
    counts.each([&](const LabelCount& count) {
      const Material material = chosen.of(count.label);
      if (material == exterior) {
        builder.leave_out();
        return true;
      }
      const auto found = merged.find(material);
      const std::uint64_t voxels = found == merged.end() ? count.voxels : found->second.voxels;
      if (voxels < least || (most != 0 && voxels > most))
        builder.leave_out();
      else
        builder.add(count.label, count.label, {0, 0, false, material});
      return true;
    });
  };
  RuleBuilder measure(false);
  measure.keep_nothing();
  build(measure);
  if (const std::uint64_t bytes = measure.count() * sizeof(MaterialRange); bytes > memory)
    throw InputError(fmt::format(
        "labels.min_voxels, labels.max_voxels: telling {} labels by their sizes takes {} ranges of "
        "labels, {}, and run.memory leaves {}; raise run.memory",
        counts.summary().labels, measure.count(), readable_bytes(static_cast<double>(bytes)),
        readable_bytes(static_cast<double>(memory))));
  RuleBuilder builder(false);
  build(builder);
  return {std::move(builder).ranges(), false};
}

void each_material(const MaterialRules& rules, const LabelCounts& counts,
                   const std::function<bool(const LabelCount&)>& f) {
  const auto merged = merged_counts(rules, counts);
  auto next = merged.begin();
  bool more = true;
  // Merged materials below the label; false where f has enough.
  const auto pass = [&](std::uint64_t label, bool with_it) {
    for (;
         more && next != merged.end() && (next->first < label || (with_it && next->first == label));
         ++next)
      if (next->second.voxels != 0) more = f(next->second);
    return more;
  };
  counts.each([&](const LabelCount& count) {
    if (!pass(count.label, true)) return false;
    if (rules.of(count.label) == count.label && !merged.contains(count.label)) more = f(count);
    return more;
  });
  if (more) pass(exterior, false);
}

std::string background_in_map(const LabelsConfig& config, const LabelMap& map) {
  const Ranges left_out = background(config);
  constexpr std::size_t most_told = 5;
  std::size_t found = 0;
  std::string text;
  for (const MaterialRange& entry : map.entries) {
    const bool changed =
        !entry.own && entry.material != exterior && !contains(left_out, entry.material);
    if (!changed || common({{entry.first, entry.last}}, left_out).empty()) continue;
    if (++found <= most_told) text += fmt::format("{}{}", found == 1 ? "" : ", ", entry.first);
  }
  if (found > most_told) text += fmt::format(" and {} more", found - most_told);
  return text;
}

}  // namespace voxweld
