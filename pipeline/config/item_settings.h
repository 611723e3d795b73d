// A list of tables of a config file, such as [[edit]]: what keys its items take. Each item is of one
// kind (an edit's shape), which says what else it takes. Parsing and validation, help, schema and the
// commented files are made from it, as they are from the table of settings.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/config/settings.h"

namespace voxweld {

// `required` is meant for the kinds that take the key and can not do without.
template <class Item, class Kind>
struct ItemSetting : KeyFacts {
  std::vector<Kind> kinds;         // that take it; empty: all
  std::vector<Kind> optional_for;  // that take the default where it is `required`
  std::string sample;              // a value as TOML, for examples

  // Precondition: check(rule, value) accepts.
  std::function<void(Item&, const ConfigValue&)> set;
  // The value in its one canonical form; empty where the item leaves it open.
  std::function<std::optional<ConfigValue>(const Item&)> get;

  bool taken_by(Kind kind) const {
    return kinds.empty() || std::ranges::find(kinds, kind) != kinds.end();
  }
  bool required_by(Kind kind) const {
    return required && taken_by(kind) &&
           std::ranges::find(optional_for, kind) == optional_for.end();
  }
};

template <class Item, class Kind>
struct ItemTable {
  using Setting = ItemSetting<Item, Kind>;
  struct Value {
    const Setting* setting = nullptr;
    ConfigValue value;
  };

  std::string name;         // "edit", as in [[edit]]
  std::string one;          // "an edit"
  std::string kind_key;     // the key that says what kind it is: "shape"
  std::string noun;         // what the kinds are, behind their names: " filter", or nothing
  std::string description;  // what they are for, in one paragraph
  Stage stage;              // whose work is done again when an item changes
  std::string reruns;       // in words: "build, where it reaches"
  Kind Item::*kind;
  std::vector<std::string> kind_names;  // by enumerator
  std::vector<Setting> settings;        // in the order of keys in a config file

  // Null when there is none of that name.
  const Setting* find(std::string_view key) const {
    const auto found =
        std::ranges::find_if(settings, [&](const Setting& setting) { return setting.key == key; });
    return found == settings.end() ? nullptr : &*found;
  }
  // Of all kinds, or those that one takes.
  std::vector<std::string> key_names(std::optional<Kind> of = {}) const {
    std::vector<std::string> names;
    for (const Setting& setting : settings)
      if (!of || setting.taken_by(*of)) names.push_back(setting.key);
    return names;
  }

  std::vector<Kind> kinds() const {
    std::vector<Kind> all;
    for (std::size_t i = 0; i < kind_names.size(); ++i) all.push_back(static_cast<Kind>(i));
    return all;
  }
  const std::string& kind_name(Kind of) const { return kind_names[static_cast<std::size_t>(of)]; }
  // "cylinder, cone", or "all"
  std::string kinds_text(const Setting& setting) const {
    std::vector<std::string_view> names;
    for (const Kind taking : setting.kinds) names.push_back(kind_name(taking));
    return names.empty() ? "all" : fmt::format("{}", fmt::join(names, ", "));
  }

  // The keys the item's kind takes and the item has values for, in table order.
  std::vector<Value> values_of(const Item& item) const {
    std::vector<Value> values;
    for (const Setting& setting : settings)
      if (auto value = setting.taken_by(item.*kind) ? setting.get(item) : std::nullopt)
        values.push_back({&setting, std::move(*value)});
    return values;
  }
};

}  // namespace voxweld
