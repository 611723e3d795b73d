// Volumes that keep their place in the world without VolumeGeometry::first.
#pragma once

#include "storage/types/volume.h"

namespace voxweld {

// The same place, with sample (0, 0, 0) at the coordinates 0.
inline VolumeGeometry counted_from_zero(VolumeGeometry geometry) {
  for (int axis = 0; axis < 3; ++axis)
    geometry.origin =
        geometry.origin + geometry.direction[static_cast<std::size_t>(axis)] * geometry.first[axis];
  geometry.first = {};
  return geometry;
}

}  // namespace voxweld
