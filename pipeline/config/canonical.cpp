#include <fmt/format.h>

#include "pipeline/config/config.h"
#include "pipeline/config/edit_settings.h"
#include "pipeline/config/filter_settings.h"
#include "pipeline/config/settings.h"

namespace voxweld {
namespace {

template <class Item, class Kind>
std::string tables_of(const ItemTable<Item, Kind>& table, const std::vector<Item>& items) {
  std::string text;
  for (const Item& item : items) {
    text += fmt::format("\n[[{}]]\n", table.name);
    for (const auto& value : table.values_of(item))
      text += value.setting->key + " = " + to_toml(value.value) + "\n";
  }
  return text;
}

}  // namespace

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
  text += tables_of(filter_items(), config.filters);
  text += tables_of(edit_items(), config.edits);
  return text;
}

}  // namespace voxweld
