// What a task has to report of the stages it ran.
#pragma once

#include <exception>
#include <string>

#include "pipeline/stage/context.h"
#include "storage/manifest/task_report.h"

namespace voxweld {

// error: what ended it, or null.
TaskReport task_report(const RunContext& context, const std::string& stage,
                       const std::exception* error);

}  // namespace voxweld
