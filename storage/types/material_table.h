// What materials are called and how they look: for the manifest and for the colours of meshes. No
// geometry depends on it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "storage/types/material.h"

namespace voxweld {

struct MaterialColor {
  std::uint8_t red = 0, green = 0, blue = 0;  // sRGB
  friend bool operator==(const MaterialColor&, const MaterialColor&) = default;
};

struct MaterialEntry {
  Material material = exterior;
  std::string name;  // UTF-8; may be empty
  std::optional<MaterialColor> color;
  friend bool operator==(const MaterialEntry&, const MaterialEntry&) = default;
};

struct MaterialTable {
  std::vector<MaterialEntry> entries;  // ascending by material; those something is known of

  // Null where nothing is known of the material.
  const MaterialEntry* find(Material material) const {
    const auto at =
        std::lower_bound(entries.begin(), entries.end(), material,
                         [](const MaterialEntry& e, Material m) { return e.material < m; });
    return at != entries.end() && at->material == material ? &*at : nullptr;
  }
  friend bool operator==(const MaterialTable&, const MaterialTable&) = default;
};

}  // namespace voxweld
