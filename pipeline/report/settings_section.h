// The config of a run, as a part of a page.
#pragma once

#include <string>

#include "storage/manifest/manifest.h"

namespace voxweld {

struct Config;

// The settings that differ from their defaults, the config file's text where that file is still
// there and asks for the same, and else the effective config, as the manifest keeps it.
std::string settings_section(const Manifest& manifest, const Config& config);

}  // namespace voxweld
