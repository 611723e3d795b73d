// Refine where nothing but what intersects is mended: it only finds that, and leaves the mesh as stitch
// did.
#pragma once

#include <memory>

#include "pipeline/refine/refine_stage.h"

namespace voxweld {

// Its artifacts have no pieces, but list what intersects, for mend.
std::unique_ptr<StageWork> find_stage(const RefineInputs& inputs);

}  // namespace voxweld
