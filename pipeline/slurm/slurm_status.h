// How far a config's work is, by what lies on the disk, and what Slurm has of it in its queue.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/config/settings.h"
#include "pipeline/slurm/queued_tasks.h"
#include "pipeline/stage/context.h"

namespace voxweld {

struct StageState {
  Stage stage = Stage::ingest;
  std::string noun;                    // of its units: "shards"
  std::uint64_t units = 0, there = 0;  // results on the disk, and how many there are to be
  bool known = false;                  // false: it waits for the stage before
};

// Tasks of one array that are in the queue, or that ended and said they failed.
struct QueuedArray {
  KnownArray array;
  std::uint64_t pending = 0, running = 0;
  std::vector<std::string> nodes;    // of those running, each once
  std::vector<std::string> reasons;  // of those pending, each once
};

struct FailedTask {
  KnownArray array;
  std::int64_t task = 0;
  std::string why;
  std::filesystem::path log;
};

struct RunStatus {
  std::vector<StageState> stages;
  std::vector<QueuedArray> queue;
  std::vector<FailedTask> failed;
  std::string queue_unknown;  // why Slurm could not be asked; empty when it could
  bool finished = false;      // the output is complete

  bool queued() const { return !queue.empty(); }
};

// By their reports. Only of each step's newest array: what that did not repeat has been made up
// for.
std::vector<FailedTask> failed_tasks(const Config& config);

// Reads no samples; nothing is changed.
RunStatus run_status(RunContext& context, SlurmClient& client);
std::string to_text(const RunStatus& status);
nlohmann::json to_json(const RunStatus& status);

// What the tasks that had the unit (a shard's or tile's number) in that stage wrote, newest last,
// each with its log's path before it; of all failed tasks where no unit is asked for.
std::string task_logs(const Config& config, const RunStatus& status,
                      std::optional<std::uint64_t> unit);

}  // namespace voxweld
