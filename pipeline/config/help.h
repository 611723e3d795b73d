// What the settings are, as text for a terminal.
#pragma once

#include <string>

namespace voxweld {

// Every setting: name, accepted values, default, stages, description; at most 100 columns.
std::string settings_help();
// Of one table, one key, or all keys that have this name in some table: "surface",
// "surface.isovalue", "directory"; of edits "edit" and "edit.radius". InputError where there is
// none, with the nearest.
std::string settings_help(const std::string& name);

}  // namespace voxweld
