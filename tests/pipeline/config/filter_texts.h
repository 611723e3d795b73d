// Filters for tests, one of each type with every key its type takes.
#pragma once

#include <map>
#include <string>

#include "pipeline/config/config_value.h"
#include "pipeline/config/filter_settings.h"

namespace voxweld::testing {

// given: keys that get other values than the table's samples; an empty one: left out.
inline std::string filter_sample(FilterType type,
                                 const std::map<std::string, std::string>& given = {}) {
  std::string text = "[[filter]]\n";
  for (const FilterSetting& setting : filter_items().settings) {
    if (!setting.taken_by(type)) continue;
    const auto found = given.find(setting.key);
    const std::string value = found != given.end()    ? found->second
                              : setting.key == "type" ? toml_string(filter_items().kind_name(type))
                                                      : setting.sample;
    if (!value.empty()) text += setting.key + " = " + value + "\n";
  }
  return text;
}

}  // namespace voxweld::testing
