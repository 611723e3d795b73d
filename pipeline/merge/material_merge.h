// The nodes of all shards to a top tree and a tile plan for each material: each label
// (labels.mode = "each"), or the only one there is.
#pragma once

#include "pipeline/stage/artifacts.h"

namespace voxweld {

// Writes the top artifact. memory: of several materials, bytes of the shards' nodes that are held at
// once; those of more lie in a scratch file in the job's folder meanwhile. Beside them it holds of one
// material its tiles, the cubes of shards it has a surface in, and its leaves above them.
void merge_materials(const MergeJob& job, std::uint64_t memory);

}  // namespace voxweld
