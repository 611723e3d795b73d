// Build: every shard of the volume to its octree artifact.
#pragma once

#include "pipeline/stage/artifacts.h"
#include "pipeline/stage/context.h"

namespace voxweld {

// Units are numbered as grid.all_shards().
std::vector<Unit> shard_units(const BrickGrid& grid, const std::vector<std::uint64_t>& numbers);

struct BuildStatus {
  std::vector<std::uint64_t> missing;  // no artifact, a damaged one, or other parameters'
  // There is one, but its input stamp is not the volume's: its samples are to be compared.
  std::vector<std::uint64_t> unproven;
  bool current() const { return missing.empty() && unproven.empty(); }
};
// Of the units context selects; reads no samples.
BuildStatus build_status(const RunContext& context, const BuildJob& job);

// Reads the samples of the unproven again and compares their content hash with what the artifacts
// were made from (shown as a stage "check"): those that are the same get the volume's stamp, the
// others become missing.
void prove(RunContext& context, const BuildJob& job, BuildStatus& status);

// Builds what is missing.
void run_build(RunContext& context, const BuildJob& job);

}  // namespace voxweld
