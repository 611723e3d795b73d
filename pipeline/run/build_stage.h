// Build: every shard of the volume to its octree artifact.
#pragma once

#include "pipeline/run/context.h"
#include "pipeline/solids/streamed_mesh.h"
#include "storage/artifact/container.h"

namespace voxweld {

struct BuildJob {
  Volume volume;
  BrickGrid grid;
  ContourParameters parameters;
  std::filesystem::path folder;
  Hash128 key;
  // Part of the brick store could not be made: shards that would read it are left out.
  bool partial_input = false;
  LargestBin largest_bin = {};  // of a mesh as the input that lies in pieces
};

// Of the shard's octree: the parameters, and the edits that reach it. What an edit does not reach
// stays as it is when the edit comes, changes or goes.
Hash128 shard_key(const BuildJob& job, Index3 shard);
// The same of one brick.
Hash128 brick_key(const BuildJob& job, Index3 brick);

std::filesystem::path shard_artifact_path(const BuildJob& job, Index3 shard);

// The shard's artifact, whichever kind of octrees it holds.
ArtifactReader open_octrees(const BuildJob& job, Index3 shard);

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
