// Lattice points as places.
#pragma once

#include "storage/types/box.h"

namespace voxweld::testing {

inline Vec3 as_vec3(Index3 at) {
  return {static_cast<double>(at.x), static_cast<double>(at.y), static_cast<double>(at.z)};
}

}  // namespace voxweld::testing
