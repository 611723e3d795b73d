// Which coordinates the files of a run hold.
#pragma once

#include "pipeline/config/config.h"
#include "storage/types/lattice_frame.h"
#include "storage/types/volume.h"

namespace voxweld {

struct OutputFrame {
  VolumeGeometry geometry;  // of the files: what their manifest says
  LatticeFrame volume;
  Vec3 first{};  // as StitchParameters has it
};

// As the input's geometry has it, where floats hold these coordinates on the run's lattice. Else, of
// what is far from 0, the volume's first sample is at 0, the rest is left to geometry.origin, and a
// warning says so. InputError as plan_lattice.
//
// A crop takes part in the lattice of its whole volume, since spacing * its first sample need not
// be a multiple of the lattice's step.
OutputFrame output_frame(const Config& config, const VolumeGeometry& geometry);

}  // namespace voxweld
