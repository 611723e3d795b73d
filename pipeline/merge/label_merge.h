// Merge of a label volume (labels.mode = "each"): a top tree and a tile plan for each label.
#pragma once

#include "pipeline/merge/merge_stage.h"

namespace voxweld {

// memory: bytes of the shards' nodes that are held at once; those of more lie in a scratch file in
// the job's folder meanwhile. Beside them it holds of one label its tiles, the cubes of shards it
// has a surface in, and its leaves above them.
void merge_labels(const MergeJob& job, std::uint64_t memory);

}  // namespace voxweld
