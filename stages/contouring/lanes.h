// How many of a kind are computed at once, and where their numbers lie.
#pragma once

#include <array>
#include <cstddef>

namespace voxweld {

inline constexpr std::size_t lanes = 8;
using LaneArray = std::array<double, lanes>;

}  // namespace voxweld
