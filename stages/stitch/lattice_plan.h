// The output lattice of a run, from the volume's extent and the precision asked for.
#pragma once

#include "storage/types/output_lattice.h"

namespace voxweld {

struct LatticeRequest {
  Index3 size;  // samples a side
  Vec3 spacing{1, 1, 1};
  double precision = 0.01;  // in the units of the spacing
  Index3 first{};           // sample numbers are counted from: of a crop, its lowest sample
};

// step: the largest power of two at most `precision` and at most a quarter of the smallest spacing.
// Covers the domain's ring: from (first - 1) * spacing to (first + size) * spacing on each axis. So
// the lattices of two crops of one volume are parts of the same lattice.
// Throws InputError when more than max_lattice_bits are needed, with the precision that would do.
OutputLattice plan_lattice(const LatticeRequest& request);

}  // namespace voxweld
