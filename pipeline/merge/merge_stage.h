// Merge: the shards' root records to the top tree and the tile plan, in one streaming pass.
#pragma once

#include "pipeline/stage/artifacts.h"
#include "pipeline/stage/stage_work.h"

namespace voxweld {

// Whether there is a top tree of these parameters, without a look at the octrees.
bool merge_is_there(const MergeJob& job);

// One unit: the top tree. job: outlives the work.
std::unique_ptr<StageWork> merge_stage(const MergeJob& job);

}  // namespace voxweld
