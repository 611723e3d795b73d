// Colours by which labels can be told apart.
#pragma once

#include <array>

#include "storage/types/material.h"

namespace voxweld {

// Linear red, green, blue in [0.25, 0.85]: hues a golden angle apart, so that close numbers differ.
std::array<double, 3> label_colour(Material label);

}  // namespace voxweld
