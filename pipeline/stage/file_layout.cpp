#include "pipeline/stage/file_layout.h"

#include <fmt/format.h>

namespace voxweld {

std::string short_hex(Hash128 hash) {
  return to_hex(hash).substr(0, 12);
}

std::optional<Stage> stage_of_folder(const std::filesystem::path& folder) {
  const std::string name = folder.filename().string();
  const auto dash = name.find('-');
  if (dash == std::string::npos || name.size() != dash + 13) return std::nullopt;
  if (name.find_first_not_of("0123456789abcdef", dash + 1) != std::string::npos)
    return std::nullopt;
  for (const Stage stage : all_stages)
    if (name.substr(0, dash) == stage_name(stage)) return stage;
  return std::nullopt;
}

std::filesystem::path fanned_out(const std::filesystem::path& root, Index3 at,
                                 const std::string& name) {
  // At most 16 x 16 x 16 / 16 files a folder of the last level: folders by z and by (y, x) / 16.
  return root / fmt::format("{:03x}", at.z) / fmt::format("{:02x}{:02x}", at.y / 16, at.x / 16) /
         name;
}

}  // namespace voxweld
