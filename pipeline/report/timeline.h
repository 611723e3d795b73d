// When which node worked on what, of a run on a cluster.
#pragma once

#include <span>
#include <string>

#include "pipeline/slurm/task_times.h"

namespace voxweld {

struct Timeline {
  std::string intro, html;  // a sentence or two, and the chart; empty where there is no task
};
Timeline timeline(std::span<const TaskTime> tasks);

}  // namespace voxweld
