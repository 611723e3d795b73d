// A mesh as a file gives it: corners by number, no connectivity beyond that.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "storage/types/box.h"

namespace voxweld {

struct TriangleMesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

}  // namespace voxweld
