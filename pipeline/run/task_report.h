// What one task of a stage says of itself when it ends, for whoever started it elsewhere: JSON,
// renamed into place. A task without a report was killed, or its node is gone.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/run/context.h"

namespace voxweld {

struct TaskReport {
  std::string stage;
  std::uint64_t units = 0;  // those it made
  StageFigures figures;
  int exit_code = 0;
  std::string error;  // empty when it did all
  std::string provenance;
};

TaskReport task_report(const RunContext& context, const std::string& stage);
void write_task_report(const std::filesystem::path& path, const TaskReport& report);
// Nothing when there is none, or not a whole one.
std::optional<TaskReport> read_task_report(const std::filesystem::path& path);

}  // namespace voxweld
