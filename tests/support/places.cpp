#include "tests/support/temp_directory.h"

namespace voxweld::testing {

std::filesystem::path shared_data(const std::string& name) {
  return std::filesystem::path(VOXWELD_SHARED_DATA) / name;
}

std::filesystem::path program_path() {
  return VOXWELD_BINARY;
}

}  // namespace voxweld::testing
