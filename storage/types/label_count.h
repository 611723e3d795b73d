// How many samples of a label there are, and where.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "storage/types/box.h"

namespace voxweld {

struct LabelCount {
  std::uint64_t label = 0;
  std::uint64_t voxels = 0;  // samples of it
  // The smallest box that holds them, half-open, along x, y, z.
  std::array<std::uint32_t, 3> lo{}, hi{};

  Box3 box() const { return {{lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}}; }
  friend bool operator==(const LabelCount&, const LabelCount&) = default;
};
static_assert(sizeof(LabelCount) == 40, "is stored as it is");

// Adds what a part has of the same label. Exact: the order of the parts does not matter.
// Precondition: both have samples.
inline void add(LabelCount& sum, const LabelCount& part) {
  sum.voxels += part.voxels;
  for (std::size_t a = 0; a < 3; ++a) {
    sum.lo[a] = std::min(sum.lo[a], part.lo[a]);
    sum.hi[a] = std::max(sum.hi[a], part.hi[a]);
  }
}

}  // namespace voxweld
