// What the settings are, as text for a terminal.
#pragma once

#include <string>

namespace voxweld {

// Every setting: name, accepted values, default, stages, description; at most 100 columns.
std::string settings_help();

}  // namespace voxweld
