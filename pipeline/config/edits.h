// The edits of the config as the solids they are.
#pragma once

#include "pipeline/config/config.h"

namespace voxweld {

// In the order of the config. Equal edits give the same bits on every machine. Meshes are yet to be
// read (pipeline/solids/edit_meshes.h).
Edits edits_of(const Config& config);

}  // namespace voxweld
