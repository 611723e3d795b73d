// A run: what is missing of the stages, in their order.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "pipeline/config/settings.h"
#include "pipeline/stage/context.h"

namespace voxweld {

// Does all that is missing and nothing twice. Artifacts found damaged are named, removed and made
// again. Throws InputError for what the user can mend (an empty surface among it).
// at_end: called while the output directory is still this run's, once all is done.
void run_all(RunContext& context, const std::function<void()>& at_end = {});

// One stage alone; InputError naming the stage to run first when what it needs is not there.
void run_one(RunContext& context, Stage stage);

// What run_all would do and why, as text for the terminal.
std::string dry_run(RunContext& context);

}  // namespace voxweld
