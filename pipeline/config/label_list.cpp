#include "pipeline/config/label_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <string_view>

#include "pipeline/config/suggest.h"

namespace voxweld {
namespace {

constexpr auto most_of_toml = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());

std::optional<std::uint64_t> whole(std::string_view text) {
  std::uint64_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stop != end) return std::nullopt;
  return value;
}

// Whatever the order and size of its ends.
std::optional<LabelRange> parsed(const ConfigValue& item) {
  if (const auto* number = item.integer()) {
    if (*number < 0) return std::nullopt;
    const auto label = static_cast<std::uint64_t>(*number);
    return LabelRange{label, label};
  }
  if (item.text() == nullptr) return std::nullopt;
  const std::string_view text = *item.text();
  const std::size_t dash = text.find('-');
  const auto first = whole(text.substr(0, dash));
  const auto last = dash == std::string_view::npos ? first : whole(text.substr(dash + 1));
  if (!first || !last) return std::nullopt;
  return LabelRange{*first, *last};
}

std::string hint_for(const ConfigValue& item) {
  const auto range = parsed(item);
  if (!range) return "found " + describe(item) + " in it";
  if (range->first > range->last)
    return fmt::format("the lower end comes first: \"{}-{}\"", range->last, range->first);
  return fmt::format("labels end at {}", highest_label);
}

std::string nearest_word(const std::vector<std::string>& words, const std::string& text) {
  const std::string nearest = nearest_name(text, words);
  return nearest.empty() ? "" : "did you mean " + toml_string(nearest) + "?";
}

ConfigValue item_of(const LabelRange& range) {
  if (range.first != range.last) return {fmt::format("{}-{}", range.first, range.last)};
  return integer_value(range.first);
}

}  // namespace

std::optional<LabelRange> label_range_of(const ConfigValue& item) {
  const auto range = parsed(item);
  if (!range || range->first > range->last || range->last > highest_label) return std::nullopt;
  return range;
}

std::optional<std::uint64_t> label_of(const ConfigValue& item) {
  const auto range = label_range_of(item);
  const bool dash = item.text() != nullptr && item.text()->find('-') != std::string::npos;
  return range && !dash ? std::optional(range->first) : std::nullopt;
}

std::optional<std::uint64_t> large_integer_of(const ConfigValue& item) {
  const auto integer = item.text() == nullptr ? std::nullopt : whole(*item.text());
  return integer && *integer > most_of_toml ? integer : std::nullopt;
}

ConfigValue integer_value(std::uint64_t integer) {
  if (integer > most_of_toml) return {std::to_string(integer)};
  return {static_cast<std::int64_t>(integer)};
}

std::vector<LabelRange> label_ranges_of(const ConfigValue::List& items) {
  std::vector<LabelRange> ranges;
  for (const ConfigValue& item : items) ranges.push_back(label_range_of(item).value());
  std::sort(ranges.begin(), ranges.end(),
            [](const LabelRange& a, const LabelRange& b) { return a.first < b.first; });
  std::vector<LabelRange> apart;
  for (const LabelRange& range : ranges) {
    if (apart.empty() || apart.back().last + 1 < range.first)
      apart.push_back(range);
    else
      apart.back().last = std::max(apart.back().last, range.last);
  }
  return apart;
}

ConfigValue::List label_items(const std::vector<LabelRange>& ranges) {
  ConfigValue::List items;
  for (const LabelRange& range : ranges) items.push_back(item_of(range));
  return items;
}

Verdict check_label(const ConfigValue& value) {
  if (label_of(value)) return {true, {}};
  const bool digits = value.text() != nullptr && !value.text()->empty() &&
                      value.text()->find_first_not_of("0123456789") == std::string::npos;
  return {false, digits ? fmt::format("labels end at {}", highest_label) : ""};
}

Verdict check_label_list(const LabelListRule& rule, const ConfigValue& value) {
  const auto* items = value.list();
  if (items == nullptr && label_range_of(value))
    return {false, "write it in brackets: [" + to_toml(value) + "]"};
  if (const std::string* text = value.text()) {
    if (std::find(rule.words.begin(), rule.words.end(), *text) != rule.words.end())
      return {true, {}};
    return {false, nearest_word(rule.words, *text)};
  }
  if (items == nullptr) return {};
  if (items->empty()) return {rule.may_be_empty, {}};
  for (const ConfigValue& item : *items)
    if (!label_range_of(item)) return {false, hint_for(item)};
  return {true, {}};
}

}  // namespace voxweld
