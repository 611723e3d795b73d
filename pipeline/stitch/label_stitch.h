// Stitch of a label volume (labels.mode = "each"): batch by batch, one mesh at a time.
#pragma once

#include "pipeline/stitch/stitch_work.h"

namespace voxweld {

std::unique_ptr<StitchWork> label_stitch(const StitchJob& job, const TopArtifact& top);

}  // namespace voxweld
