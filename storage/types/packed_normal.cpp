#include <cmath>

#include "storage/types/tile_mesh.h"

namespace voxweld {
namespace {

constexpr double scale = 32767.0;

double sign_not_zero(double v) {
  return v < 0 ? -1.0 : 1.0;
}

}  // namespace

PackedNormal pack_normal(Vec3 n) {
  const double sum = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
  double u = n.x / sum, v = n.y / sum;
  if (n.z < 0) {
    const double folded = (1 - std::abs(v)) * sign_not_zero(u);
    v = (1 - std::abs(u)) * sign_not_zero(v);
    u = folded;
  }
  return {static_cast<std::int16_t>(std::floor(u * scale + 0.5)),
          static_cast<std::int16_t>(std::floor(v * scale + 0.5))};
}

Vec3 unpack_normal(PackedNormal packed) {
  double u = packed.u / scale, v = packed.v / scale;
  const double z = 1 - std::abs(u) - std::abs(v);
  if (z < 0) {
    const double folded = (1 - std::abs(v)) * sign_not_zero(u);
    v = (1 - std::abs(u)) * sign_not_zero(v);
    u = folded;
  }
  const Vec3 n{u, v, z};
  return n * (1 / std::sqrt(dot(n, n)));
}

}  // namespace voxweld
