#include "pipeline/config/help.h"

#include <fmt/format.h>

#include "pipeline/config/edit_settings.h"
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

std::string edits_head() {
  return wrapped(fmt::format("[[{}]] {}", edit_table, edit_description()), "");
}

std::string help_of(const Setting& setting) {
  return key_help(setting, "re-runs: " + setting.stages_text());
}

std::string help_of(const EditSetting& setting) {
  return key_help(
      setting, fmt::format("shapes: {}; re-runs: build, where it reaches", setting.shapes_text()));
}

// The keys of a table that are asked for, below its head; empty where there is none.
template <class Keys, class Asked>
std::string part(const std::string& head, const Keys& keys, Asked&& asked) {
  std::string text;
  for (const auto& key : keys)
    if (asked(key)) text += help_of(key);
  return text.empty() ? text : head + text;
}

// taken(table, key): whether it is asked for.
template <class Taken>
std::string help_where(Taken&& taken) {
  std::string text;
  const auto add = [&](const std::string& one) {
    text += (text.empty() || one.empty() ? "" : "\n") + one;
  };
  for (const std::string& table : table_names())
    add(part(head_of(table), settings(), [&](const Setting& setting) {
      return setting.table == table && taken(setting.table, setting.key);
    }));
  add(part(edits_head(), edit_settings(),
           [&](const EditSetting& setting) { return taken(edit_table, setting.key); }));
  return text;
}

std::vector<std::string> all_names() {
  std::vector<std::string> names = table_names();
  names.emplace_back(edit_table);
  for (const Setting& setting : settings())
    names.insert(names.end(), {setting.name(), setting.key});
  for (const EditSetting& setting : edit_settings())
    names.insert(names.end(), {fmt::format("{}.{}", edit_table, setting.key), setting.key});
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
