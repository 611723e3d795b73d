#include "pipeline/slurm/task_plan.h"

#include <algorithm>
#include <cmath>

#include "pipeline/run/unit_selection.h"

namespace voxweld {
namespace {

constexpr double longest_s = 180;  // what a task should take at most
constexpr double shortest_s = 5;   // and at least: Slurm takes about a second to start one
constexpr double tasks_per_slot = 4;

double target_weight(double total, const TaskPlanRequest& request) {
  const double slots = static_cast<double>(std::max<std::int64_t>(request.slots, 1));
  double target = total / (tasks_per_slot * slots);
  if (request.seconds_per_weight > 0) {
    const double per_weight =
        request.seconds_per_weight / static_cast<double>(request.cpus_per_task);
    target = std::clamp(target, shortest_s / per_weight, longest_s / per_weight);
  }
  return target;
}

}  // namespace

std::vector<PlannedTask> plan_tasks(std::span<const Unit> units, const TaskPlanRequest& request) {
  std::vector<Unit> sorted(units.begin(), units.end());
  std::sort(sorted.begin(), sorted.end(),
            [](const Unit& a, const Unit& b) { return a.key < b.key; });
  double total = 0;
  for (const Unit& unit : sorted) total += unit.weight;
  const double target = target_weight(total, request);
  const auto per_task = static_cast<std::size_t>(request.units_per_task);

  std::vector<PlannedTask> tasks;
  std::uint64_t together = 0;
  for (const Unit& unit : sorted) {
    const bool tied = !tasks.empty() && unit.together != 0 && unit.together == together;
    const bool full = tasks.empty() ||
                      (request.units_per_task > 0 ? tasks.back().units.size() >= per_task
                                                  : tasks.back().weight + unit.weight / 2 > target);
    if (full && !tied) tasks.emplace_back();
    tasks.back().units.push_back(unit.key);
    tasks.back().weight += unit.weight;
    together = unit.together;
  }
  std::stable_sort(tasks.begin(), tasks.end(),
                   [](const PlannedTask& a, const PlannedTask& b) { return a.weight > b.weight; });
  return tasks;
}

std::string task_arguments(StageName stage, const PlannedTask& task) {
  if (stage == "merge") return "--log-level info";  // all of it, and a line must not be empty
  const bool shards = stage == "ingest" || stage == "build";
  return std::string(shards ? "--shards " : "--tiles ") + unit_list(task.units);
}

}  // namespace voxweld
