// The part of a mesh that has a say in one brick.
#pragma once

#include <cstdint>
#include <vector>

#include "storage/types/box.h"

namespace voxweld {

struct MeshBin {
  // Three of each triangle, in the order of the mesh, in steps of 2^-20 of a cell from sample 0.
  std::vector<Index3> corners;
  // Of a box of samples: which of those with its lowest x are inside. A bit each, y first.
  std::vector<std::uint64_t> first;
};

inline std::uint64_t row_count(const Box3& samples) {
  return static_cast<std::uint64_t>((samples.hi.y - samples.lo.y) * (samples.hi.z - samples.lo.z));
}
inline std::uint64_t row_words(const Box3& samples) {
  return (row_count(samples) + 63) / 64;
}
inline std::uint64_t row_number(const Box3& samples, std::int64_t y, std::int64_t z) {
  return static_cast<std::uint64_t>((z - samples.lo.z) * (samples.hi.y - samples.lo.y) + y -
                                    samples.lo.y);
}

}  // namespace voxweld
