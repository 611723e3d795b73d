// Build: every shard of the volume to its octree artifact.
#pragma once

#include "pipeline/run/context.h"

namespace voxweld {

struct BuildJob {
  Volume volume;
  BrickGrid grid;
  ContourParameters parameters;
  std::filesystem::path folder;
  Hash128 key;
};

std::filesystem::path shard_artifact_path(const BuildJob& job, Index3 shard);

// The shards whose artifact is missing, damaged or made from other samples. Where the volume's
// stamp is not the one the artifacts were last checked under, their samples are read again and
// compared by content hash (shown as a stage "check").
std::vector<Index3> missing_shards(RunContext& context, const BuildJob& job);

// Builds what is missing.
void run_build(RunContext& context, const BuildJob& job);

}  // namespace voxweld
