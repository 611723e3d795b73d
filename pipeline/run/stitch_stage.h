// Stitch: every planned tile to its mesh on the output lattice.
#pragma once

#include "pipeline/run/merge_stage.h"
#include "pipeline/run/unit_plan.h"
#include "stages/stitch/tile_stitcher.h"

namespace voxweld {

struct StitchJob {
  const BuildJob* build = nullptr;
  const MergeJob* merge = nullptr;
  StitchParameters parameters;
  std::filesystem::path folder;
  Hash128 key;
};

std::filesystem::path tile_artifact_path(const StitchJob& job, const UnitPlan& plan,
                                         std::uint64_t unit);

// Which of the units context selects are missing or made from other inputs. Precondition: merge is
// current.
std::vector<std::uint64_t> missing_tiles(const RunContext& context, const StitchJob& job,
                                         const TopArtifact& top);
void run_stitch(RunContext& context, const StitchJob& job);

}  // namespace voxweld
