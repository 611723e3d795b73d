// The config of the run before, kept in the work directory, to say what changed.
#pragma once

#include <string>

#include "pipeline/config/settings.h"

namespace voxweld {

inline constexpr const char* last_config_name = "last-run.toml";

void write_last_config(const Config& config);
// "simplify.tolerance was 0.1, is 0.2" for the settings this stage reads; empty when there are none
// or nothing is known.
std::string changed_since_last(const Config& config, Stage stage);

}  // namespace voxweld
