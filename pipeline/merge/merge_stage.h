// Merge: the shards' root records to the top tree and the tile plan, in one streaming pass.
#pragma once

#include "pipeline/stage/artifacts.h"
#include "pipeline/stage/context.h"
#include "stages/merge/shard_reduction.h"
#include "storage/artifact/shard_artifact.h"
#include "storage/artifact/top_artifact.h"

namespace voxweld {

// A shard's part of the counts, and what merge itself found final.
void add_summary(const ShardSummary& shard, MergeCounts& counts);
void add_reduced(const TopReduction& reduction, MergeCounts& counts);

// Precondition: no shard is missing.
// Whether there is a top tree of these parameters, without a look at the octrees.
bool merge_is_there(const MergeJob& job);
bool merge_is_current(const MergeJob& job);
void run_merge(RunContext& context, const MergeJob& job);

}  // namespace voxweld
