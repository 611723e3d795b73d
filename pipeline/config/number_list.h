// Lists of numbers as people type them on a command line, whatever takes them.
#pragma once

#include <optional>
#include <string>

#include "pipeline/config/config_value.h"
#include "pipeline/config/rule.h"

namespace voxweld {

// "1,2,3", "1 2 3", "1x2x3" or any of them in brackets; empty where the text is none of these.
// Whole numbers are integers.
std::optional<ConfigValue::List> parse_number_list(const std::string& text);

// What was typed for a key of that rule: TOML, a bare word or, where the rule takes several
// numbers, a list in any of the ways above; of labels ranges too: 1,5,10-20. Numbers may lack the 0
// that TOML wants beside the point: .5. Empty where it is meant as TOML and is not.
std::optional<ConfigValue> typed_value(const Rule& rule, const std::string& text);

}  // namespace voxweld
