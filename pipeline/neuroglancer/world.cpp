#include "pipeline/neuroglancer/world.h"

#include <cmath>

#include "stages/encode/glb.h"

namespace voxweld {

std::array<double, 12> nanometre_matrix(const VolumeGeometry& frame) {
  // By way of whole picometres: 1e-9 * 1e9 need not be 1.
  const std::optional<double> metres = metres_per(frame.unit);
  const double scale = metres ? std::round(*metres * 1e12) / 1e3 : 1;
  std::array<double, 12> matrix{};
  for (std::size_t r = 0; r < 3; ++r) {
    const int row = static_cast<int>(r);
    for (std::size_t c = 0; c < 3; ++c) matrix[4 * r + c] = frame.direction[c][row] * scale + 0.0;
    matrix[4 * r + 3] = frame.origin[row] * scale + 0.0;
  }
  return matrix;
}

bool is_mirrored(const VolumeGeometry& frame) {
  const auto& [x, y, z] = frame.direction;
  return dot(x, cross(y, z)) < 0;
}

}  // namespace voxweld
