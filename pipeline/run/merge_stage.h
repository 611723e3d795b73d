// Merge: the shards' root records to the top tree and the tile plan, in one streaming pass.
#pragma once

#include "pipeline/run/build_stage.h"
#include "storage/artifact/shard_artifact.h"
#include "storage/artifact/top_artifact.h"

namespace voxweld {

struct MergeJob {
  const BuildJob* build = nullptr;
  std::filesystem::path folder;
  Hash128 key;  // of the parameters; the artifact also says which octrees it was merged from
  std::uint64_t tile_vertices = 500000;

  std::filesystem::path path() const { return folder / "top.tree"; }
};

// A shard's part of the counts.
void add_summary(const ShardSummary& shard, MergeCounts& counts);

// Precondition: no shard is missing.
// Whether there is a top tree of these parameters, without a look at the octrees.
bool merge_is_there(const MergeJob& job);
bool merge_is_current(const MergeJob& job);
void run_merge(RunContext& context, const MergeJob& job);

}  // namespace voxweld
