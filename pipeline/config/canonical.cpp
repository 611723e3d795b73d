#include <fmt/format.h>

#include "pipeline/config/config.h"
#include "pipeline/config/edit_settings.h"
#include "pipeline/config/settings.h"

namespace voxweld {

std::string canonical_toml(const Config& config) {
  std::string text;
  std::string_view table;
  for (const Setting& setting : settings()) {
    if (table != setting.table) {
      text += (text.empty() ? "[" : "\n[") + setting.table + "]\n";
      table = setting.table;
    }
    const auto value = setting.get(config);
    // An open setting is the same as one not written, so it is only a remark.
    text += value ? setting.key + " = " + to_toml(*value) + "\n"
                  : "# " + setting.key + ": " + setting.default_note + "\n";
  }
  for (const EditConfig& edit : config.edits) {
    text += fmt::format("\n[[{}]]\n", edit_table);
    for (const EditValue& value : values_of(edit))
      text += value.setting->key + " = " + to_toml(value.value) + "\n";
  }
  return text;
}

}  // namespace voxweld
