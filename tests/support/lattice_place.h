// Lattice points as places.
#pragma once

#include "storage/types/box.h"

namespace voxweld::testing {

using voxweld::as_vec3;

}  // namespace voxweld::testing
