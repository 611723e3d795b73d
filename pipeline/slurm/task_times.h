// When the tasks of a run ran, and where, from what they and the driver have left on the disk.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/config/config.h"

namespace voxweld {

// Times are seconds since 1970, by the clock of the node or of whoever submitted.
struct TaskTime {
  std::string stage, node;
  double submitted = 0, began = 0, ended = 0;
  bool failed = false;  // by its own report
  bool lost = false;  // without a report: killed, or its node is gone; `began` is `ended`, the last
                      // time that its log grew
  bool again = false;  // of an array that does what one before it left undone
  std::uint64_t units = 0;
};

// Of the job arrays that made the meshes of this config, in the order in which they were submitted. Empty where
// it has never run on Slurm, or its work folder is gone.
std::vector<TaskTime> task_times(const Config& config);

}  // namespace voxweld
