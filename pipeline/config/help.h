// What the settings are, as text for a terminal and as a page of documentation.
#pragma once

#include <string>

namespace voxweld {

// Every setting: name, accepted values, default, stages, description; at most 100 columns.
std::string settings_help();

// The same as Markdown, a table of settings for each table of the config.
// configs/SETTINGS.md is this text.
std::string settings_markdown();

}  // namespace voxweld
