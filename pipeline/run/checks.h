// What a run refuses or warns of before it does a stage's work, and --dry-run with it.
#pragma once

#include "pipeline/run/stages.h"

namespace voxweld {

// All throw InputError.

// A directory that cannot be written.
void check_directories(const Config& config);

// What is to be known before a stage's first unit. Precondition: the stages before it are current.
void check_before(RunContext& context, Stages& stages, Stage stage);

// What doing what is missing of it would be refused for.
void check_work(const RunContext& context, StageWork& work, const StageLook& look);

// Warns of each [[edit]] that cannot change anything, since it lies outside the volume. Precondition: ingest is current.
void warn_of_idle_edits(Stages& stages);

}  // namespace voxweld
