// What a config's work will take on a cluster, before any of it is done: an estimate from the
// volume's size, a look at a few of its bricks and rates measured elsewhere; beside it what tasks
// have reported since.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/config/settings.h"
#include "pipeline/run/brick_sample.h"

namespace voxweld {

struct PlannedStage {
  Stage stage = Stage::ingest;
  std::uint64_t units = 0, tasks = 0;
  std::uint64_t files = 0, disk_bytes = 0;  // that it leaves
  double cpu_s = 0;
  double used_cpu_s = 0;  // as far as tasks have reported
  std::uint64_t used_peak_bytes = 0;
};

struct WorkPlan {
  std::vector<PlannedStage> stages;
  std::uint64_t bricks = 0;
  std::optional<BrickSample> sample;  // nothing: rates of ordinary scans instead
  double vertices = 0;
  std::uint64_t spool_bytes = 0;  // of the slices of one layer, while ingest reads them
  std::uint64_t task_bytes = 0;   // memory asked for
  std::int64_t task_cpus = 0;
  std::uint64_t tasks_reported = 0;
};

// Reads a few bricks, writes nothing. slots: tasks that run at once, where known.
WorkPlan plan_work(const RunContext& context, const Jobs& jobs, std::int64_t slots);
std::string to_text(const WorkPlan& plan);
nlohmann::json to_json(const WorkPlan& plan);

}  // namespace voxweld
