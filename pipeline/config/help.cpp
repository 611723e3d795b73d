#include "pipeline/config/help.h"

#include <fmt/format.h>

#include "pipeline/config/edit_settings.h"
#include "pipeline/config/settings.h"
#include "pipeline/config/text_layout.h"

namespace voxweld {
namespace {

std::string stages_text(const Setting& setting) {
  std::string text;
  for (const Stage stage : setting.stages) {
    if (!text.empty()) text += ", ";
    text += stage_name(stage);
  }
  return text.empty() ? "none" : text;
}

// A bar would end the cell, an angle bracket begin a tag.
std::string cell(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '|' || c == '<') out += '\\';
    out += c;
  }
  return out;
}

std::string edits_help() {
  std::string text = "\n";
  text += wrapped(fmt::format("[[{}]] {}", edit_table, edit_description()), "");
  for (const EditSetting& setting : edit_settings()) {
    text += wrapped(fmt::format("{}: {}", setting.key, setting.description), "  ");
    text += wrapped("takes " + accepted_text(setting.rule), "      ");
    text += wrapped(fmt::format("default: {}; shapes: {}; re-runs: build, where it reaches",
                                setting.default_text(), setting.shapes_text()),
                    "      ");
  }
  return text;
}

std::string edits_markdown() {
  std::string text = fmt::format("\n## [[{}]]\n\n", edit_table);
  text += wrapped(std::string(edit_description()) +
                      " A change re-runs build where the edit reaches or reached.",
                  "");
  text += "\n| key | type | accepted | default | shapes | meaning |\n";
  text += "| --- | --- | --- | --- | --- | --- |\n";
  for (const EditSetting& setting : edit_settings())
    text += fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", setting.key, type_text(setting.rule),
                        cell(accepted_text(setting.rule)), cell(setting.default_text()),
                        setting.shapes_text(), cell(setting.description));
  return text;
}

}  // namespace

std::string settings_help() {
  std::string text;
  for (const std::string& table : table_names()) {
    text += fmt::format("{}[{}] {}\n", text.empty() ? "" : "\n", table, table_description(table));
    for (const Setting& setting : settings()) {
      if (setting.table != table) continue;
      text += wrapped(fmt::format("{}: {}", setting.key, setting.description), "  ");
      text += wrapped("takes " + accepted_text(setting.rule), "      ");
      text += wrapped(
          fmt::format("default: {}; re-runs: {}", setting.default_text(), stages_text(setting)),
          "      ");
    }
  }
  return text + edits_help();
}

std::string settings_markdown() {
  std::string text = "# Settings\n\n";
  text += wrapped(
      "Every key of the config file, its accepted values and its default. \"Re-runs\" names the "
      "stages whose work is done again when the key changes; later stages follow where their "
      "inputs change. Relative paths are relative to the config file's folder.",
      "");
  for (const std::string& table : table_names()) {
    text += fmt::format("\n## [{}]\n\n{}\n\n", table, table_description(table));
    text += "| key | type | accepted | default | re-runs | meaning |\n";
    text += "| --- | --- | --- | --- | --- | --- |\n";
    for (const Setting& setting : settings()) {
      if (setting.table != table) continue;
      text +=
          fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", setting.key, type_text(setting.rule),
                      cell(accepted_text(setting.rule)), cell(setting.default_text()),
                      stages_text(setting), cell(setting.description));
    }
  }
  return text + edits_markdown();
}

}  // namespace voxweld
