// Survey and recount: how many triangles a pass of refine would leave, by how far edges are collapsed.
#pragma once

#include <memory>

#include "pipeline/refine/refine_stage.h"

namespace voxweld {

// Its units are those of refine.
std::unique_ptr<StageWork> survey_stage(const RefineInputs& inputs);

}  // namespace voxweld
