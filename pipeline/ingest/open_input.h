// The input volume of a config, through whichever reader knows it.
#pragma once

#include <memory>

#include "pipeline/config/config.h"
#include "pipeline/solids/mesh_input.h"
#include "storage/types/volume.h"

namespace voxweld {

std::shared_ptr<SampleSource> open_input(const Config& config);

// The input where that is a mesh; else null.
std::shared_ptr<MeshVolume> open_mesh(const Config& config);

}  // namespace voxweld
