// The input volume of a config, through whichever reader knows it.
#pragma once

#include <memory>
#include <vector>

#include "pipeline/config/config.h"
#include "pipeline/solids/mesh_input.h"
#include "storage/readers/open_volume.h"
#include "storage/types/volume.h"

namespace voxweld {

// The readers of storage, with those for Zarr arrays and image stacks.
std::vector<ReaderEntry> all_readers();

std::shared_ptr<SampleSource> open_input(const Config& config);

// The input where that is a mesh; else null.
std::shared_ptr<MeshVolume> open_mesh(const Config& config);

}  // namespace voxweld
