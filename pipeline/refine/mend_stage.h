// Mend: what still intersects after refine and seams, repaired in boxes of its own. It leaves only the
// pieces that are not as seams left them.
#pragma once

#include <memory>

#include "pipeline/refine/refine_stage.h"

namespace voxweld {

// Its units are those of refine.
std::unique_ptr<StageWork> mend_stage(const RefineInputs& inputs);

}  // namespace voxweld
