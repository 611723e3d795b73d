// Units to tasks of a job array. A pure function.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pipeline/executor/executor.h"
#include "pipeline/stage/unit_selection.h"

namespace voxweld {

struct TaskPlanRequest {
  double seconds_per_weight = 0;  // of one processor; 0: not known
  std::int64_t cpus_per_task = 1;
  std::int64_t slots = 1;           // tasks the cluster runs at once, as far as is known
  std::int64_t units_per_task = 0;  // the most, as the config asks for; 0: to be chosen
};

struct PlannedTask {
  std::vector<std::uint64_t> units;  // keys, ascending
  double weight = 0;
};

// A task should take minutes, so that starting it costs little, and there should be several for
// each slot, so that none is left to run alone at the end. Units keep their order and neighbours
// stay together; units that share a costly read are never parted, be they more than units_per_task.
// The largest task comes first.
std::vector<PlannedTask> plan_tasks(std::span<const Unit> units, const TaskPlanRequest& request);

// How many tasks that makes of units of the same weight, together `total`, which share nothing. Takes
// no memory, however many they are.
std::uint64_t count_even_tasks(std::uint64_t units, double total, const TaskPlanRequest& request);

// The units that a line of task arguments names: a list, a part, or all of them. InputError when
// the line is none that voxweld wrote.
UnitSelection task_selection(const std::string& line);

// The options of voxweld's stage command that name a task's units: "--shards 0-63".
std::string task_arguments(StageName stage, const PlannedTask& task);

}  // namespace voxweld
