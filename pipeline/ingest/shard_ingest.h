// Ingest by shards: copied to the brick store, their labels counted, or both.
#pragma once

#include <string>

#include "pipeline/ingest/ingest_stage.h"

namespace voxweld {

// Units are shards, x fastest. job: outlives the work.
std::unique_ptr<StageWork> shard_ingest(const Config& config, const IngestJob& job);

// What --dry-run says where nothing is copied.
inline constexpr const char* read_in_place_text = "nothing to do: the input is read in place";

// Whether there is one of the input as it is.
bool histogram_is_current(const IngestJob& job);
// Whether the job makes its histogram: it is needed, and not that of an earlier ingest.
bool makes_histogram(const IngestJob& job);
// What is missing beside units, for --dry-run: the histogram that the isovalue is to be chosen
// from, what comes before the filters of an input that is read in place. Empty: nothing.
std::string missing_besides(const IngestJob& job);

}  // namespace voxweld
