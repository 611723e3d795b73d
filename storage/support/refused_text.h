// What the system refused, where it was asked through std::filesystem: a link that leads to itself, a
// folder that may not be searched.
#pragma once

#include <filesystem>
#include <string>

namespace voxweld {

inline std::string refused_text(const std::filesystem::filesystem_error& error) {
  return "cannot use " + error.path1().string() + ": " + error.code().message();
}

}  // namespace voxweld
