// Retile: the refined mesh cut into tiles anew, as encode takes them.
#pragma once

#include <memory>

#include "pipeline/refine/retile_plan.h"
#include "pipeline/stage/artifacts.h"
#include "pipeline/stage/stage_work.h"

namespace voxweld {

// Units as the plan has them, which lies in the stage's folder before they are begun. All three
// outlive the work.
std::unique_ptr<StageWork> retile_stage(const RetileJob& job, CubeMeshes& meshes, RetilePlan& plan);

}  // namespace voxweld
