#include "pipeline/config/help.h"

#include <fmt/format.h>

#include "pipeline/config/edit_settings.h"
#include "pipeline/config/settings.h"
#include "pipeline/config/text_layout.h"

namespace voxweld {
namespace {

// more: what follows its default.
std::string key_help(const KeyFacts& key, const std::string& more) {
  return wrapped(fmt::format("{}: {}", key.key, key.description), "  ") +
         wrapped("takes " + accepted_text(key.rule), "      ") +
         wrapped(fmt::format("default: {}; {}", key.default_text(), more), "      ");
}

std::string edits_help() {
  std::string text = "\n";
  text += wrapped(fmt::format("[[{}]] {}", edit_table, edit_description()), "");
  for (const EditSetting& setting : edit_settings())
    text += key_help(setting, fmt::format("shapes: {}; re-runs: build, where it reaches",
                                          setting.shapes_text()));
  return text;
}

}  // namespace

std::string settings_help() {
  std::string text;
  for (const std::string& table : table_names()) {
    text += fmt::format("{}[{}] {}\n", text.empty() ? "" : "\n", table, table_description(table));
    for (const Setting& setting : settings())
      if (setting.table == table) text += key_help(setting, "re-runs: " + setting.stages_text());
  }
  return text + edits_help();
}

}  // namespace voxweld
