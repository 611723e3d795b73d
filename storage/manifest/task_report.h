// What one task of a stage says of itself when it ends, for whoever started it elsewhere: JSON,
// renamed into place. A task without a report was killed, or its node is gone.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "storage/types/nan_count.h"

namespace voxweld {

struct TaskFailure {
  std::optional<std::uint64_t> unit;  // its number; nothing: not one unit's
  std::string message;
  int exit_code = 1;         // 2: the user's to mend, so that doing it again does not help
  std::string damaged_path;  // an artifact that has to be made again; else empty
};

struct TaskReport {
  std::string stage;
  std::uint64_t units = 0;  // those it made
  double wall_s = 0;
  double ended = 0;                 // seconds since 1970 by the clock of its machine; 0: not told
  double cpu_s = 0;                 // of all its threads
  std::uint64_t peak_resident = 0;  // bytes
  NanCount nans;                    // among the samples it read
  int exit_code = 0;
  std::vector<TaskFailure> failures;  // none when it did all
  std::string provenance;
};

void write_task_report(const std::filesystem::path& path, const TaskReport& report);
// Nothing when there is none, or not a whole one.
std::optional<TaskReport> read_task_report(const std::filesystem::path& path);

}  // namespace voxweld
