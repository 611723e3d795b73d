// The meshes that edits name: read, checked, put in their places.
#pragma once

#include "pipeline/config/config.h"
#include "storage/types/solid.h"
#include "storage/types/volume.h"

namespace voxweld {

// Gives each edit of shape "mesh" its solid. edits: edits_of(config), moved to the frame spacing *
// index.
// InputError or FormatError for a file that is missing or damaged, a mesh that is not closed, too
// far from the volume or too large for run.memory.
void load_edit_meshes(const Config& config, const VolumeGeometry& geometry, Edits& edits);

}  // namespace voxweld
