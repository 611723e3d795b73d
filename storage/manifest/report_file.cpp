#include "storage/manifest/report_file.h"

#include <array>
#include <fstream>

namespace voxweld {

bool is_report(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return false;
  std::array<char, 512> beginning{};
  std::ifstream file(path, std::ios::binary);
  file.read(beginning.data(), beginning.size());
  return std::string_view(beginning.data(), static_cast<std::size_t>(file.gcount()))
             .find(report_mark) != std::string_view::npos;
}

}  // namespace voxweld
