// A path given on the command line, as a config holds it.
#pragma once

#include <filesystem>
#include <string>

namespace voxweld {

// Relative when the input lies below the config's folder, so that both can be moved together.
// Throws InputError where a config cannot hold it.
std::string path_for_config(const std::string& input, const std::filesystem::path& config);

}  // namespace voxweld
