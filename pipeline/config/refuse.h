// The parts of which messages about a config are made.
#pragma once

#include <string>
#include <vector>

#include "pipeline/config/settings.h"

namespace voxweld {

std::string joined(const std::vector<std::string>& names);  // "a, b, c"
// Names come from the file, so they are shown cut and escaped.
std::string shown(const std::string& name);
// "; did you mean work.chunk?"; empty for an empty name.
std::string did_you_mean(const std::string& name);

// Throws InputError unless the key takes the value: "where: name: expected ..., found ...".
void require_accepted(const std::string& where, const std::string& name, const KeyFacts& key,
                      const ConfigValue& value);

}  // namespace voxweld
