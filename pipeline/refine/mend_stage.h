// Mend: what still intersects after refine and seams, repaired in boxes of its own. It leaves a patch.
// Where the mesh is only repaired, seams is one such stage too: it mends what find has found, in small
// boxes. Remend is one more: it mends what mend left at borders of its boxes.
#pragma once

#include <memory>

#include "pipeline/refine/refine_stage.h"

namespace voxweld {

// Its units are those of refine.
std::unique_ptr<StageWork> mend_stage(const RefineInputs& inputs);

}  // namespace voxweld
