#include "pipeline/stage/unit_selection.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <iterator>

#include "storage/support/error.h"

namespace voxweld {
namespace {

std::optional<std::uint64_t> number(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

UnitSelection UnitSelection::list(std::string_view text, std::string_view option) {
  const auto refuse = [&] {
    throw InputError(fmt::format(
        "{} \"{}\": expected numbers and ranges in rising order, such as 0-63,70", option, text));
  };
  UnitSelection selection;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t comma = std::min(text.find(',', at), text.size());
    const std::string_view item = text.substr(at, comma - at);
    const std::size_t dash = item.find('-');
    const auto first = number(item.substr(0, dash));
    const auto last = dash == std::string_view::npos ? first : number(item.substr(dash + 1));
    if (!first || !last || *last < *first) refuse();
    if (!selection.ranges_.empty() && selection.ranges_.back().last >= *first) refuse();
    selection.ranges_.push_back({*first, *last});
    at = comma + 1;
  }
  return selection;
}

UnitSelection UnitSelection::part(std::string_view text) {
  const std::size_t slash = text.find('/');
  const auto part = number(text.substr(0, slash));
  const auto parts =
      slash == std::string_view::npos ? std::nullopt : number(text.substr(slash + 1));
  if (!part || !parts || *part >= *parts)
    throw InputError(
        fmt::format("--part \"{}\": expected K/N with K from 0 to N - 1, such as 3/16", text));
  UnitSelection selection;
  selection.part_ = *part;
  selection.parts_ = *parts;
  return selection;
}

bool UnitSelection::contains(std::uint64_t unit) const {
  if (unit % parts_ != part_) return false;
  if (ranges_.empty()) return true;
  const auto after =
      std::upper_bound(ranges_.begin(), ranges_.end(), unit,
                       [](std::uint64_t u, const Range& range) { return u < range.first; });
  return after != ranges_.begin() && unit <= std::prev(after)->last;
}

std::uint64_t UnitSelection::count(std::uint64_t units) const {
  if (all()) return units;
  std::uint64_t found = 0;
  for (std::uint64_t unit = 0; unit < units; ++unit) found += contains(unit) ? 1 : 0;
  return found;
}

std::vector<std::uint64_t> UnitSelection::among(std::span<const std::uint64_t> units) const {
  std::vector<std::uint64_t> found;
  const auto add = [&](auto first, auto last) {
    std::copy_if(first, last, std::back_inserter(found),
                 [&](std::uint64_t unit) { return unit % parts_ == part_; });
  };
  if (ranges_.empty()) add(units.begin(), units.end());
  for (const Range& range : ranges_)
    add(std::lower_bound(units.begin(), units.end(), range.first),
        std::upper_bound(units.begin(), units.end(), range.last));
  return found;
}

void UnitSelection::check(std::string_view stage, std::string_view noun,
                          std::uint64_t count) const {
  if (ranges_.empty() || ranges_.back().last < count) return;
  throw InputError(fmt::format("--{} names {}, but stage {} has {} of them (0 to {})", noun,
                               ranges_.back().last, stage, count, count == 0 ? 0 : count - 1));
}

std::string unit_list(const std::vector<std::uint64_t>& units) {
  std::string text;
  for (std::size_t i = 0; i < units.size();) {
    std::size_t j = i;
    while (j + 1 < units.size() && units[j + 1] == units[j] + 1) ++j;
    if (!text.empty()) text += ',';
    text += j == i ? fmt::format("{}", units[i]) : fmt::format("{}-{}", units[i], units[j]);
    i = j + 1;
  }
  return text;
}

}  // namespace voxweld
