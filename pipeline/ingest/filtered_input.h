// An input with filters. Filters that need boxes of what the input gives otherwise, or all of it
// before they give one sample, are preceded by an ingest of their own; the others are read through.
#pragma once

#include "pipeline/ingest/ingest_stage.h"

namespace voxweld {

// Of a config with filters: info, input, earlier and pieces. Opens the input; throws
// what plan_ingest throws, and InputError where a filter does not fit it.
IngestJob plan_filtered(const Config& config, const std::filesystem::path& folder,
                        const InterruptFlag* interrupt);

// What has to be there before samples of the job's input can be read.
bool earlier_is_current(const IngestJob& job);
// Makes it, in this process.
void finish_earlier(RunContext& context, const IngestJob& job);

// The ingest whose histogram the isovalue is chosen from: filters that ask what is inside, and all
// that comes after them, go by one isovalue.
const IngestJob& histogram_job(const IngestJob& job);

}  // namespace voxweld
