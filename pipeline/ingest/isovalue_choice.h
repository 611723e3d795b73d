// The isovalue where the config leaves it to the volume.
#pragma once

#include "pipeline/ingest/ingest_stage.h"
#include "stages/ingest/threshold.h"

namespace voxweld {

// By surface.isovalue_rule, from the histogram that ingest leaves. InputError where the histogram
// has no threshold.
IsovalueSuggestion choose_isovalue(const Config& config, const IngestJob& job);

}  // namespace voxweld
