// How a volume lies on the output lattice.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "storage/types/output_lattice.h"

namespace voxweld {

// Lattice point u of the volume lies at (first + u - 1) * spacing, and there cell u begins.
struct LatticeFrame {
  OutputLattice lattice;
  Vec3 spacing{1, 1, 1};
  Index3 first{};  // sample numbers are counted from: of a crop, its lowest sample
  // Samples a side. The volume ends where the next ones would be. No vertex lies beyond that, but for at
  // most most_snap_steps where others lie.
  Index3 size = splat(std::numeric_limits<std::int32_t>::max());

  // These count steps from 0 of the output's coordinates; lattice points are counted from the lattice's
  // origin.
  double begin_of_cell(int axis, std::int64_t cell) const {
    return static_cast<double>(first[axis] + cell - 1) * spacing[axis] / lattice.step;
  }
  std::int64_t end(int axis) const {  // the first that is not within the volume, or on its end
    return static_cast<std::int64_t>(std::ceil(begin_of_cell(axis, size[axis] + 1)));
  }
  std::int64_t origin(int axis) const {
    return static_cast<std::int64_t>(lattice.origin[static_cast<std::size_t>(axis)] / lattice.step);
  }
};

}  // namespace voxweld
