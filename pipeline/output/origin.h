// Whether an output directory is of the input and config that its manifest names.
#pragma once

#include <vector>

#include "pipeline/output/verify.h"
#include "storage/manifest/manifest.h"

namespace voxweld {

// What of them is there and no longer what the meshes were made of: of files the size and the time
// of modification, of the config what it asks for. Nothing of what is not there any more.
std::vector<Problem> check_origin(const Manifest& manifest);

}  // namespace voxweld
