#include "pipeline/stage/file_layout.h"

#include <fmt/format.h>

namespace voxweld {
namespace {

constexpr const char* extract_name = "extract";

// "<name>-<12 hexadecimal digits>" -> name; else nothing.
std::optional<std::string> name_with_hash(const std::filesystem::path& folder) {
  const std::string name = folder.filename().string();
  const auto dash = name.find('-');
  if (dash == std::string::npos || name.size() != dash + 13) return std::nullopt;
  if (name.find_first_not_of("0123456789abcdef", dash + 1) != std::string::npos)
    return std::nullopt;
  return name.substr(0, dash);
}

}  // namespace

std::string short_hex(Hash128 hash) {
  return to_hex(hash).substr(0, 12);
}

std::optional<Stage> stage_of_folder(const std::filesystem::path& folder) {
  const std::optional<std::string> name = name_with_hash(folder);
  for (const Stage stage : all_stages)
    if (name == stage_name(stage)) return stage;
  return std::nullopt;
}

std::filesystem::path extract_folder(const std::filesystem::path& work, Hash128 hash) {
  return work / (std::string(extract_name) + "-" + short_hex(hash));
}

bool is_extract_folder(const std::filesystem::path& folder) {
  return name_with_hash(folder) == extract_name;
}

std::filesystem::path fanned_out(const std::filesystem::path& root, Index3 at,
                                 const std::string& name) {
  // At most 16 x 16 x 16 / 16 files a folder of the last level: folders by z and by (y, x) / 16.
  return root / fmt::format("{:03x}", at.z) / fmt::format("{:02x}{:02x}", at.y / 16, at.x / 16) /
         name;
}

}  // namespace voxweld
