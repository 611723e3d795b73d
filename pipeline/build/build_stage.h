// Build: every shard of the volume to its octree artifact.
#pragma once

#include "pipeline/stage/artifacts.h"
#include "pipeline/stage/shard_memory.h"
#include "pipeline/stage/stage_work.h"

namespace voxweld {

// Units are shards, numbered as grid.all_shards(). job: outlives the work.
std::unique_ptr<StageWork> build_stage(const BuildJob& job);

// The shards of these numbers as units, weighed by their bricks alone.
std::vector<Unit> shard_units(const BrickGrid& grid, std::span<const std::uint64_t> numbers);

// The stage's need, but for what a mesh as the input takes besides.
StageMemory build_memory(const BrickGrid& grid, const ShardMemory& shard);

}  // namespace voxweld
