// The job arrays of a config, and what Slurm has of them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/config/config.h"
#include "pipeline/slurm/array_folder.h"
#include "pipeline/slurm/slurm_client.h"

namespace voxweld {

// One array or job that was submitted for a config, or was about to be.
struct KnownArray {
  std::string step;  // "build-...", or "submitted-build" of a chain
  ArrayFolder folder;
  std::int64_t job = 0;  // 0: its id was never written down
};

// Those of one step, oldest first.
std::vector<KnownArray> arrays_of_step(const std::filesystem::path& step);
// Oldest first in each step.
std::vector<KnownArray> known_arrays(const Config& config);

struct QueuedTasks {
  KnownArray array;
  std::vector<TaskState> tasks;  // as many as Slurm still knows, at least one; some may be over

  bool alive() const;  // not all are over
};

// Those of the arrays that Slurm knows, in the same order, each with its job's id, also where that
// was never written down. A job is an array's when it has its name: an id alone may be another's,
// since a controller that lost its last seconds gives ids again. A job that Slurm took twice is
// there twice.
std::vector<QueuedTasks> queued_tasks(const std::vector<KnownArray>& arrays, SlurmClient& client);

}  // namespace voxweld
