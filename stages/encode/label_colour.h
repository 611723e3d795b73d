// Colours by which labels can be told apart.
#pragma once

#include <array>

#include "storage/types/material_table.h"

namespace voxweld {

// Linear red, green, blue in [0.25, 0.85]: hues a golden angle apart, so that close numbers differ.
std::array<double, 3> label_colour(Material label);

// The one a table gives, which is sRGB, as linear red, green, blue in [0, 1], to five decimals;
// nothing where it gives none.
std::optional<std::array<double, 3>> given_colour(const MaterialTable& table, Material label);

}  // namespace voxweld
