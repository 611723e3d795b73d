// Triangles around a vertex that lie beside each other as their shadows do.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "stages/exact/orientation.h"

namespace voxweld {

// A direction of small integers, so that products with a normal, which has up to 46 bits, are exact.
// Zeros: none.
using Along = std::array<std::int16_t, 3>;

inline bool runs_along(const Index3& normal, const Along& along) {
  return normal.x * along[0] + normal.y * along[1] + normal.z * along[2] > 0;
}

// The axis along which a vector is longest.
inline int longest_axis(Vec3 v) {
  int axis = 0;
  for (int a = 1; a < 3; ++a)
    if (std::abs(v[a]) > std::abs(v[axis])) axis = a;
  return axis;
}

// The direction of a vector, rounded. None where it has no length.
inline Along direction_of(Vec3 v) {
  constexpr double most = 127;
  const double longest = std::abs(v[longest_axis(v)]);
  Along along{};
  if (!(longest > 0)) return along;
  for (int a = 0; a < 3; ++a)
    along[static_cast<std::size_t>(a)] =
        static_cast<std::int16_t>(std::lround(v[a] * (most / longest)));
  return along;
}

// Whether triangles that make a ring around a vertex, seen along a direction, run the same way and once
// around. Then they have nothing in common but what they share. A ring passes a plane through the vertex
// that the direction lies in twice for each time it goes around.
class ShadowTurns {
 public:
  explicit ShadowTurns(const Along& along) : along_(along) {
    const int axis = longest_axis(as_vec3({along[0], along[1], along[2]}));
    // At a right angle to it.
    across_[axis] = -std::int64_t{along[static_cast<std::size_t>((axis + 1) % 3)]};
    across_[(axis + 1) % 3] = along[static_cast<std::size_t>(axis)];
  }

  // A triangle: the vertex, and its others in their order. Whether it runs the same way.
  bool add(const LatticePoint& at, const LatticePoint& next, const LatticePoint& last,
           const Index3& normal) {
    changes_ += is_before(at, next) != is_before(at, last) ? 1u : 0u;
    return runs_along(normal, along_);
  }
  // Precondition: all run the same way.
  bool once() const { return changes_ == 2; }

 private:
  bool is_before(const LatticePoint& at, const LatticePoint& p) const {
    const Index3 way = lattice_vector(at, p);
    return across_.x * way.x + across_.y * way.y + across_.z * way.z < 0;
  }

  Along along_;
  Index3 across_;
  std::uint32_t changes_ = 0;
};

}  // namespace voxweld
