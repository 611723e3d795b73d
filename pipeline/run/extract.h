// A mesh of a larger tolerance from what a run has left, without its samples.
#pragma once

#include "pipeline/stage/context.h"

namespace voxweld {

// Makes what run_all(context) makes, byte for byte, but cuts the octrees of context.extraction's
// tolerance in place of building new ones. It leaves nothing in the work directory that was not
// there. Precondition: context.extraction is set; context.config has the larger tolerance.
// InputError where such octrees are not kept (the config), or not there (run it first).
void extract_all(RunContext& context);

}  // namespace voxweld
