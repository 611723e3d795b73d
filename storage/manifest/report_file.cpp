#include "storage/manifest/report_file.h"

#include <array>
#include <fstream>

namespace voxweld {

std::string beginning_of_page(const std::filesystem::path& path) {
  std::array<char, 512> beginning{};
  std::ifstream file(path, std::ios::binary);
  file.read(beginning.data(), beginning.size());
  return {beginning.data(), static_cast<std::size_t>(file.gcount())};
}

bool is_report(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error) &&
         beginning_of_page(path).find(report_mark) != std::string::npos;
}

}  // namespace voxweld
