#include "pipeline/config/help.h"

#include <fmt/format.h>

#include "pipeline/config/edit_settings.h"
#include "pipeline/config/filter_settings.h"
#include "pipeline/config/refuse.h"
#include "pipeline/config/settings.h"
#include "pipeline/config/suggest.h"
#include "pipeline/config/text_layout.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

// more: what follows its default.
std::string key_help(const KeyFacts& key, const std::string& more) {
  return wrapped(fmt::format("{}: {}", key.key, key.description), "  ") +
         wrapped("takes " + accepted_text(key.rule), "      ") +
         wrapped(fmt::format("default: {}; {}", key.default_text(), more), "      ");
}

std::string head_of(const std::string& table) {
  return fmt::format("[{}] {}\n", table, table_description(table));
}

std::string help_of(const Setting& setting) {
  return key_help(setting, "re-runs: " + setting.stages_text());
}

// How the items of a list are told of.
template <class Item, class Kind>
std::string head_of(const ItemTable<Item, Kind>& table) {
  return wrapped(fmt::format("[[{}]] {}", table.name, table.description), "");
}

template <class Item, class Kind>
std::string help_of(const ItemTable<Item, Kind>& table, const ItemSetting<Item, Kind>& setting) {
  return key_help(setting, fmt::format("{}s: {}; re-runs: {}", table.kind_key,
                                       table.kinds_text(setting), table.reruns));
}

// The keys of a table that are asked for, below its head; empty where there is none.
std::string below(const std::string& head, const std::string& keys) {
  return keys.empty() ? keys : head + keys;
}

// taken(table, key): whether it is asked for.
template <class Taken>
std::string help_where(Taken&& taken) {
  std::string text;
  const auto add = [&](const std::string& one) {
    text += (text.empty() || one.empty() ? "" : "\n") + one;
  };
  for (const std::string& table : table_names()) {
    std::string keys;
    for (const Setting& setting : settings())
      if (setting.table == table && taken(setting.table, setting.key)) keys += help_of(setting);
    add(below(head_of(table), keys));
  }
  const auto add_items = [&](const auto& table) {
    std::string keys;
    for (const auto& setting : table.settings)
      if (taken(table.name, setting.key)) keys += help_of(table, setting);
    add(below(head_of(table), keys));
  };
  add_items(filter_items());
  add_items(edit_items());
  return text;
}

std::vector<std::string> all_names() {
  std::vector<std::string> names = table_names();
  for (const Setting& setting : settings())
    names.insert(names.end(), {setting.name(), setting.key});
  const auto add_items = [&](const auto& table) {
    names.push_back(table.name);
    for (const auto& setting : table.settings)
      names.insert(names.end(), {fmt::format("{}.{}", table.name, setting.key), setting.key});
  };
  add_items(filter_items());
  add_items(edit_items());
  return names;
}

}  // namespace

std::string settings_help() {
  return help_where([](std::string_view, std::string_view) { return true; });
}

std::string settings_help(const std::string& name) {
  std::string text = help_where([&](std::string_view table, std::string_view key) {
    return name == table || name == key || name == fmt::format("{}.{}", table, key);
  });
  if (!text.empty()) return text;
  const std::string near = did_you_mean(nearest_name(name, all_names()));
  throw InputError(
      fmt::format("no table and no key of the config is called \"{}\"{} `voxweld "
                  "settings` lists all",
                  shown(name), near.empty() ? ";" : near));
}

}  // namespace voxweld
