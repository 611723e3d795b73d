#include "pipeline/run/report_task.h"

#include <algorithm>
#include <chrono>

#include "pipeline/executor/error_set.h"
#include "storage/support/error.h"
#include "storage/support/provenance.h"

namespace voxweld {

namespace {

std::vector<TaskFailure> failures_of(const std::exception& error) {
  std::vector<TaskFailure> failures;
  if (const auto* set = dynamic_cast<const ErrorSet*>(&error)) {
    for (const UnitError& e : set->errors())
      failures.push_back({e.interrupted ? std::nullopt : std::optional(e.key), e.message,
                          e.exit_code, e.damaged_path});
    return failures;
  }
  const auto* own = dynamic_cast<const Error*>(&error);
  const auto* damage = dynamic_cast<const DamagedArtifact*>(&error);
  return {{std::nullopt, error.what(), own != nullptr ? own->exit_code() : 1,
           damage != nullptr ? damage->path() : ""}};
}

}  // namespace

TaskReport task_report(const RunContext& context, const std::string& stage,
                       const std::exception* error) {
  TaskReport task;
  if (error != nullptr) {
    const auto* own = dynamic_cast<const Error*>(error);
    task.exit_code = own != nullptr ? own->exit_code() : 1;
    task.failures = failures_of(*error);
  }
  task.stage = stage;
  for (const StageReport& report : context.reports) {  // "check" and the stage itself
    task.units += report.ran;
    task.wall_s += report.figures.wall_s;
    task.cpu_s += report.figures.cpu_s;
    task.peak_resident = std::max(task.peak_resident, report.figures.peak_resident);
  }
  task.nans = context.nans;
  task.ended =
      std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  task.provenance = provenance_json();
  return task;
}

}  // namespace voxweld
