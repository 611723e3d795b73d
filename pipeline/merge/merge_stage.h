// Merge: the shards' root records to the top tree and the tile plan, in one streaming pass.
#pragma once

#include "pipeline/stage/artifacts.h"
#include "pipeline/stage/stage_work.h"
#include "stages/merge/shard_reduction.h"
#include "storage/artifact/shard_artifact.h"
#include "storage/artifact/top_artifact.h"

namespace voxweld {

// A shard's part of the counts, and what merge itself found final.
void add_summary(const ShardSummary& shard, MergeCounts& counts);
void add_reduced(const TopReduction& reduction, MergeCounts& counts);

// Where each sheet collapses by itself, once all else is counted.
void count_top_leaves(const BuildJob& job, MergeCounts& counts);

// Whether there is a top tree of these parameters, without a look at the octrees.
bool merge_is_there(const MergeJob& job);

// One unit: the top tree. job: outlives the work.
std::unique_ptr<StageWork> merge_stage(const MergeJob& job);

}  // namespace voxweld
