// Labels as a config and a map name them.
#pragma once

#include <cstdint>
#include <limits>

namespace voxweld {

// The largest label there may be: the number above it stands for what is outside (material.h).
inline constexpr std::uint64_t highest_label = std::numeric_limits<std::uint64_t>::max() - 1;

// The labels first .. last, both included.
struct LabelRange {
  std::uint64_t first = 0, last = 0;
  friend bool operator==(const LabelRange&, const LabelRange&) = default;
};

}  // namespace voxweld
