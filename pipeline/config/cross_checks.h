// The checks of a config that look at several settings.
#pragma once

#include <map>
#include <string>

#include "pipeline/config/config.h"

namespace voxweld {

// Where each value that was given stands: setting name to "file:line:column"; and each header of a
// filter or an edit, by its name ("edit 2").
using Places = std::map<std::string, std::string>;

// InputError naming the place of the value that does not go with the others; `file` where that is
// one that is missing.
void check_across(const Config& config, const Places& places, const std::string& file);

}  // namespace voxweld
