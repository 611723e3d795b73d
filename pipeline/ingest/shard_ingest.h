// Ingest by shards: copied to the brick store, their labels counted, or both.
#pragma once

#include "pipeline/ingest/ingest_stage.h"

namespace voxweld {

// Units are shards, x fastest. job: outlives the work.
std::unique_ptr<StageWork> shard_ingest(const Config& config, const IngestJob& job);

// What --dry-run says where nothing is copied, and where the isovalue is still to be chosen.
inline constexpr const char* read_in_place_text = "nothing to do: the input is read in place";
inline constexpr const char* no_histogram_text = "the histogram is missing";

// Whether there is one of the input as it is.
bool histogram_is_current(const IngestJob& job);

}  // namespace voxweld
