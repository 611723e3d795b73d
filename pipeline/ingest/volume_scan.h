// One pass over a volume that is read directly: histogram or range of all its samples.
#pragma once

#include <functional>

#include "pipeline/stage/context.h"
#include "storage/types/histogram.h"
#include "storage/types/volume.h"

namespace voxweld {

struct ScanResult {
  Histogram histogram;
  ValueRange range;
  Histogram border;  // of the volume's outermost samples; scan_in_order only
};

// The volume in pieces of about ingest_band_bytes as it is best read: along its chunks where it has
// any, else bands of whole rows in rising order, whole slices of a stream. Calls f with each.
void each_scan_piece(const VolumeInfo& info, const std::function<void(const Box3&)>& f);

// Reads everything once, in parallel pieces. Precondition: Access::box.
ScanResult scan_volume(RunContext& context, const SampleSource& source, const std::string& stage);

}  // namespace voxweld
