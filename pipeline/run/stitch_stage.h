// Stitch: every planned tile to its mesh on the output lattice.
#pragma once

#include "pipeline/run/merge_stage.h"
#include "stages/stitch/tile_stitcher.h"

namespace voxweld {

struct StitchJob {
  const BuildJob* build = nullptr;
  const MergeJob* merge = nullptr;
  StitchParameters parameters;
  std::filesystem::path folder;
  Hash128 key;
};

std::filesystem::path tile_artifact_path(const StitchJob& job, CellKey tile);

// Which of the tiles context selects are missing or made from other inputs, by their numbers in
// top.tiles(). Precondition: merge is current.
std::vector<std::uint64_t> missing_tiles(const RunContext& context, const StitchJob& job,
                                         const TopArtifact& top);
void run_stitch(RunContext& context, const StitchJob& job);

}  // namespace voxweld
