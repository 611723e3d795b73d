// How lattice points become places: u is sample u - 1, at spacing * (u - 1).
#pragma once

#include "storage/types/box.h"

namespace voxweld {

struct VolumeFrame {
  Index3 size;  // samples a side
  Vec3 spacing;
  Vec3 place_of_sample(Index3 s) const {
    return {spacing.x * static_cast<double>(s.x), spacing.y * static_cast<double>(s.y),
            spacing.z * static_cast<double>(s.z)};
  }
};

}  // namespace voxweld
