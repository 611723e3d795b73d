// One pass over a volume that is read directly: histogram or range of all its samples.
#pragma once

#include "pipeline/stage/context.h"
#include "storage/types/histogram.h"
#include "storage/types/volume.h"

namespace voxweld {

struct ScanResult {
  Histogram histogram;
  ValueRange range;
  Histogram border;  // of the volume's outermost samples; scan_in_order only
};

// Reads everything once, in parallel bands of slices. Precondition: Access::box.
ScanResult scan_volume(RunContext& context, const SampleSource& source, const std::string& stage);

}  // namespace voxweld
