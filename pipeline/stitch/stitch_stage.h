// Stitch: every planned tile to its mesh on the output lattice.
#pragma once

#include "pipeline/stage/artifacts.h"
#include "pipeline/stage/context.h"

namespace voxweld {

// Which of the units context selects are missing or made from other inputs. Precondition: merge is
// current.
std::vector<std::uint64_t> missing_tiles(const RunContext& context, const StitchJob& job,
                                         const TopArtifact& top);
void run_stitch(RunContext& context, const StitchJob& job);

}  // namespace voxweld
