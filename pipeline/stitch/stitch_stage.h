// Stitch: every planned tile to its mesh on the output lattice.
#pragma once

#include "pipeline/stage/artifacts.h"
#include "pipeline/stage/stage_work.h"

namespace voxweld {

// Units as the plan has them. All three outlive the work.
std::unique_ptr<StageWork> stitch_stage(const StitchJob& job, const TopArtifact& top,
                                        const UnitPlan& plan);

}  // namespace voxweld
