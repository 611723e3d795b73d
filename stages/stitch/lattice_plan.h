// The output lattice of a run, from the volume's extent and the precision asked for.
#pragma once

#include "storage/types/output_lattice.h"

namespace voxweld {

struct LatticeRequest {
  Index3 size;  // samples a side
  Vec3 spacing{1, 1, 1};
  double precision = 0.01;  // in the units of the spacing
};

// step: the largest power of two at most `precision` and at most a quarter of the smallest spacing.
// Covers the domain's ring: from -spacing to size * spacing on each axis.
// Throws InputError when more than max_lattice_bits are needed, with the precision that would do.
OutputLattice plan_lattice(const LatticeRequest& request);

}  // namespace voxweld
