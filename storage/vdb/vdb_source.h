// A grid of a .vdb file as a volume.
#pragma once

#include <memory>

#include "storage/types/volume_reader.h"

namespace voxweld {

// InputError where no grid is chosen, or it has no active voxel; FormatError where the file is
// damaged or the grid's transform is none of ours.
std::unique_ptr<SampleSource> open_vdb(const InputSpec& spec);

}  // namespace voxweld
