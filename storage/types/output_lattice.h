// The one lattice all vertices of a run are snapped to, in every tile and level, so that a vertex
// shared by two files decodes to the same bits from both (DESIGN: the output lattice).
#pragma once

#include <array>
#include <cstdint>

#include "storage/types/box.h"

namespace voxweld {

// Position of the lattice point q: origin + q * step on each axis, in output coordinates. step is a
// power of two, origin a multiple of it, and no coordinate is more than 2^24 steps from 0: so a
// float holds every one exactly and Draco decodes it exactly.
struct OutputLattice {
  double step = 1;
  int bits = 1;                    // coordinates are in [0, 2^bits); at most 22
  std::array<double, 3> origin{};  // of q = 0

  constexpr double range() const {
    return static_cast<double>((std::int64_t{1} << bits) - 1) * step;
  }
  constexpr bool fits_floats() const {
    for (const double first : origin)
      if (first < -16777216 * step || first + range() > 16777216 * step) return false;
    return true;
  }
  constexpr double coordinate(int axis, std::int32_t q) const {
    return origin[static_cast<std::size_t>(axis)] + static_cast<double>(q) * step;
  }
  friend constexpr bool operator==(const OutputLattice&, const OutputLattice&) = default;
};
inline constexpr int max_lattice_bits = 22;
// So that none coincide, vertices lie up to so many steps from where they best would, on each axis.
inline constexpr int most_snap_steps = 12;

// by: multiples of the step.
constexpr OutputLattice moved(OutputLattice lattice, Vec3 by) {
  for (int axis = 0; axis < 3; ++axis) lattice.origin[static_cast<std::size_t>(axis)] += by[axis];
  return lattice;
}

using LatticePoint = std::array<std::int32_t, 3>;  // in [0, 2^bits)

// Exact (see OutputLattice).
constexpr std::array<float, 3> float_position(const OutputLattice& lattice, const LatticePoint& q) {
  std::array<float, 3> p{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    p[axis] = static_cast<float>(lattice.coordinate(static_cast<int>(axis), q[axis]));
  return p;
}

}  // namespace voxweld
