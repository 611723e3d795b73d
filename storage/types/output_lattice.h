// The one lattice all vertices of a run are snapped to, in every tile and level, so that a vertex
// shared by two files decodes to the same bits from both (DESIGN: the output lattice).
#pragma once

#include <array>
#include <cstdint>

#include "storage/types/box.h"

namespace voxweld {

// Position of the lattice point q: origin + q * step on each axis, in the axis-aligned frame
// spacing * sample index (output units). step is a power of two and origin a multiple of it in
// [-range, 0], so a float holds every coordinate exactly and Draco decodes it exactly.
struct OutputLattice {
  double step = 1;
  int bits = 1;                    // coordinates are in [0, 2^bits); at most 22
  std::array<double, 3> origin{};  // of q = 0

  constexpr double range() const {
    return static_cast<double>((std::int64_t{1} << bits) - 1) * step;
  }
  constexpr double coordinate(int axis, std::int32_t q) const {
    return origin[static_cast<std::size_t>(axis)] + static_cast<double>(q) * step;
  }
  friend constexpr bool operator==(const OutputLattice&, const OutputLattice&) = default;
};
inline constexpr int max_lattice_bits = 22;

using LatticePoint = std::array<std::int32_t, 3>;  // in [0, 2^bits)

}  // namespace voxweld
