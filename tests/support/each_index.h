// Loops over boxes of lattice points.
#pragma once

#include "storage/types/box.h"

namespace voxweld::testing {

// f(at) for every point of the box, x the fastest.
template <class F>
void each_index(const Box3& box, F&& f) {
  for (std::int64_t z = box.lo.z; z < box.hi.z; ++z)
    for (std::int64_t y = box.lo.y; y < box.hi.y; ++y)
      for (std::int64_t x = box.lo.x; x < box.hi.x; ++x) f(Index3{x, y, z});
}
// Of a box that begins at 0.
template <class F>
void each_index(Index3 size, F&& f) {
  each_index(Box3{{}, size}, f);
}

inline Vec3 as_vec3(Index3 at) {
  return {static_cast<double>(at.x), static_cast<double>(at.y), static_cast<double>(at.z)};
}

}  // namespace voxweld::testing
