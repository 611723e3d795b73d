#include "storage/hdf5/hdf5_axes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "storage/hdf5/hdf5_attributes.h"
#include "storage/support/error.h"
#include "storage/support/text_fields.h"

namespace voxweld {
namespace {

constexpr std::int64_t most_choices = 256;
constexpr std::size_t most_tag_bytes = 65536;

// {"axes": [{"key": "z", ...}, ...]}, slowest first.
std::vector<std::string> axistag_names(const std::string& text) {
  // What nests deeper than this is no such document, and parsers need not meet it.
  if (text.size() > most_tag_bytes || std::ranges::count(text, '[') > 4) return {};
  const auto document = nlohmann::json::parse(text, nullptr, false);
  if (!document.is_object() || !document.contains("axes") || !document["axes"].is_array())
    return {};
  std::vector<std::string> names;
  for (const auto& axis : document["axes"])
    names.push_back(axis.is_object() && axis.contains("key") && axis["key"].is_string()
                        ? lower(axis["key"].get<std::string>())
                        : "");
  return names;
}

int place_of(const std::vector<std::string>& names, const char* name) {
  const auto found = std::ranges::find(names, name);
  return found == names.end() || std::ranges::count(names, name) > 1
             ? -1
             : static_cast<int>(found - names.begin());
}

// The last three dimensions, without the first ones of one sample where there are more.
VolumePlace place_by_order(const DatasetFacts& facts, const std::string& where) {
  std::vector<int> kept;
  for (std::size_t d = 0; d < facts.dims.size(); ++d) kept.push_back(static_cast<int>(d));
  while (kept.size() > 3) {
    const auto single = std::ranges::find_if(
        kept, [&](int d) { return facts.dims[static_cast<std::size_t>(d)] == 1; });
    if (single == kept.end())
      throw FormatError(fmt::format(
          "{}: has {} dimensions ({}), and nothing says which are x, y and z: name them in an "
          "attribute axistags or DIMENSION_LABELS (h5py: dataset.dims[0].label = 'z'), or copy one "
          "volume into a dataset of its own",
          where, facts.dims.size(), fmt::join(facts.dims, " x ")));
    kept.erase(single);
  }
  VolumePlace place;
  place.at.assign(facts.dims.size(), 0);
  for (std::size_t i = 0; i < kept.size(); ++i) place.dimension[kept.size() - 1 - i] = kept[i];
  return place;
}

VolumePlace place_by_name(const DatasetFacts& facts, const std::vector<std::string>& names,
                          const InputSpec& spec, const std::string& where, VolumeInfo& info) {
  VolumePlace place;
  place.at.assign(facts.dims.size(), 0);
  place.dimension = {place_of(names, "x"), place_of(names, "y"), place_of(names, "z")};
  for (std::size_t d = 0; d < names.size(); ++d) {
    if (std::ranges::count(place.dimension, static_cast<int>(d)) != 0) continue;
    const bool channel = names[d] == "c", time = names[d] == "t";
    if (!channel && !time) {
      if (facts.dims[d] == 1) continue;
      throw FormatError(fmt::format(
          "{}: dimension {} is called '{}' and has {} samples: expected x, y, z, c and t, or one "
          "sample: copy one volume into a dataset of its own",
          where, d, names[d], facts.dims[d]));
    }
    place.at[d] = choose_index({.selector = channel ? Selector::channel : Selector::time,
                                .wanted = channel ? spec.select.channel : spec.select.time,
                                .count = facts.dims[d]},
                               spec.survey, where, info);
  }
  return place;
}

void refuse_selector(Selector selector, bool set, bool there, const std::string& where) {
  if (!set || there) return;
  const char* name = selector_name(selector);
  throw InputError(fmt::format(
      "{}: input.{} (--{}) is set, but no dimension is named so: remove it", where, name, name));
}

}  // namespace

std::vector<std::string> dimension_names(hid_t dataset, std::size_t rank) {
  std::vector<std::string> names;
  if (const auto text = text_attribute(dataset, "axistags")) names = axistag_names(*text);
  if (names.size() != rank) {
    names = text_attributes(dataset, "DIMENSION_LABELS");
    for (std::string& name : names) name = lower(name);
  }
  if (names.size() != rank) names.clear();
  return names;
}

VolumePlace place_volume(const DatasetFacts& facts, const std::vector<std::string>& names,
                         const InputSpec& spec, const std::string& where, VolumeInfo& info) {
  if (facts.dims.size() < 2)
    throw FormatError(
        fmt::format("{}: has {} dimension: expected three", where, facts.dims.size()));
  const bool named = place_of(names, "x") >= 0 && place_of(names, "y") >= 0 &&
                     (place_of(names, "z") >= 0 || facts.dims.size() == 2);
  const auto has = [&](const char* name) { return named && place_of(names, name) >= 0; };
  refuse_selector(Selector::channel, spec.select.channel.has_value(), has("c"), where);
  refuse_selector(Selector::time, spec.select.time.has_value(), has("t"), where);
  const VolumePlace place =
      named ? place_by_name(facts, names, spec, where, info) : place_by_order(facts, where);
  if (place.dimension[2] < 0)
    info.warnings.push_back(where + ": has two dimensions; read as a volume of one slice");
  return place;
}

std::int64_t choose_index(const IndexChoice& choice, bool survey, const std::string& where,
                          VolumeInfo& info) {
  const char* name = selector_name(choice.selector);
  const std::int64_t chosen = choice.wanted.value_or(0);
  std::string list;
  for (std::int64_t i = 0; choice.count > 1 && i < std::min(choice.count, most_choices); ++i) {
    const auto index = static_cast<std::size_t>(i);
    const std::string text = index < choice.texts.size() ? choice.texts[index] : "";
    info.choices.push_back({name, std::to_string(i), text, i == chosen});
    if (i < 40)
      list += fmt::format("{}{}{}", i == 0 ? "" : ", ", i, text.empty() ? "" : " " + text);
  }
  if (chosen < 0 || chosen >= choice.count)
    throw InputError(fmt::format("{}: input.{} (--{}) is {}: expected a number from 0 to {}", where,
                                 name, name, chosen, choice.count - 1));
  if (choice.wanted || choice.count == 1 || choice.first_is_fine) return chosen;
  if (!survey)
    throw InputError(fmt::format("{}: holds {} {}s ({}): set input.{} or --{}", where, choice.count,
                                 name, list, name, name));
  info.warnings.push_back(
      fmt::format("{}: holds {} {}s; this is the first: set input.{} or "
                  "--{} to choose",
                  where, choice.count, name, name, name));
  return chosen;
}

Index3 size_of(const DatasetFacts& facts, const VolumePlace& place) {
  Index3 size{1, 1, 1};
  for (int a = 0; a < 3; ++a)
    if (const int d = place.dimension[static_cast<std::size_t>(a)]; d >= 0)
      size[a] = facts.dims[static_cast<std::size_t>(d)];
  return size;
}

}  // namespace voxweld
