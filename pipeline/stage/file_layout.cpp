#include "pipeline/stage/file_layout.h"

#include <fmt/format.h>

namespace voxweld {

std::string short_hex(Hash128 hash) {
  return to_hex(hash).substr(0, 12);
}

std::filesystem::path fanned_out(const std::filesystem::path& root, Index3 at,
                                 const std::string& name) {
  // At most 16 x 16 x 16 / 16 files a folder of the last level: folders by z and by (y, x) / 16.
  return root / fmt::format("{:03x}", at.z) / fmt::format("{:02x}{:02x}", at.y / 16, at.x / 16) /
         name;
}

}  // namespace voxweld
