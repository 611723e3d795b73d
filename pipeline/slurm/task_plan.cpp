#include "pipeline/slurm/task_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "pipeline/stage/stage_work.h"

namespace voxweld {
namespace {

constexpr double longest_s = 180;  // what a task should take at most
constexpr double shortest_s = 5;   // and at least: Slurm takes about a second to start one,
constexpr double least_s = 1;      // unless slots would stay empty for it
constexpr double tasks_per_slot = 4;

double target_weight(double total, const TaskPlanRequest& request) {
  const double slots = static_cast<double>(std::max<std::int64_t>(request.slots, 1));
  double target = total / (tasks_per_slot * slots);
  if (request.seconds_per_weight > 0) {
    const double per_weight =
        request.seconds_per_weight / static_cast<double>(request.cpus_per_task);
    target = std::clamp(target, shortest_s / per_weight, longest_s / per_weight);
    target = std::min(target, std::max(total / slots, least_s / per_weight));
  }
  return target;
}

// What goes into one task undivided: a unit, or all units that share a costly read.
struct Block {
  std::vector<std::uint64_t> units;
  double weight = 0;
};

// In the order of their first keys.
std::vector<Block> blocks_of(std::vector<Unit> units) {
  std::sort(units.begin(), units.end(), [](const Unit& a, const Unit& b) { return a.key < b.key; });
  std::vector<Block> blocks;
  std::unordered_map<std::uint64_t, std::size_t> block_of;  // units that go together
  for (const Unit& unit : units) {
    std::size_t at = blocks.size();
    if (unit.together != 0) at = block_of.emplace(unit.together, at).first->second;
    if (at == blocks.size()) blocks.emplace_back();
    blocks[at].units.push_back(unit.key);
    blocks[at].weight += unit.weight;
  }
  return blocks;
}

}  // namespace

std::vector<PlannedTask> plan_tasks(std::span<const Unit> units, const TaskPlanRequest& request) {
  const std::vector<Block> blocks = blocks_of({units.begin(), units.end()});
  double total = 0;
  for (const Block& block : blocks) total += block.weight;
  const double target = target_weight(total, request);
  const auto per_task = static_cast<std::size_t>(request.units_per_task);

  std::vector<PlannedTask> tasks;
  for (const Block& block : blocks) {
    const bool full =
        tasks.empty() ||
        (request.units_per_task > 0 ? tasks.back().units.size() + block.units.size() > per_task
                                    : tasks.back().weight + block.weight / 2 > target);
    if (full) tasks.emplace_back();
    PlannedTask& task = tasks.back();
    task.units.insert(task.units.end(), block.units.begin(), block.units.end());
    task.weight += block.weight;
  }
  for (PlannedTask& task : tasks) std::sort(task.units.begin(), task.units.end());
  std::stable_sort(tasks.begin(), tasks.end(),
                   [](const PlannedTask& a, const PlannedTask& b) { return a.weight > b.weight; });
  return tasks;
}

std::uint64_t count_even_tasks(std::uint64_t units, double total, const TaskPlanRequest& request) {
  if (units == 0) return 0;
  if (request.units_per_task > 0) {
    const auto per_task = static_cast<std::uint64_t>(request.units_per_task);
    return units / per_task + (units % per_task != 0 ? 1 : 0);
  }
  const double weight = total / static_cast<double>(units);
  const double target = target_weight(total, request);
  // One is added while the task's weight and half of it are within the target.
  const double per_task = weight > 0 ? std::floor(target / weight - 0.5) + 1 : HUGE_VAL;
  return static_cast<std::uint64_t>(
      std::ceil(static_cast<double>(units) / std::max(per_task, 1.0)));
}

UnitSelection task_selection(const std::string& line) {
  std::string values = line.substr(line.find(' ') + 1);
  values = values.substr(0, values.find(' '));
  if (line.starts_with("--shards ") || line.starts_with("--tiles ") ||
      line.starts_with("--ranges "))
    return UnitSelection::list(values, "tasks.txt");
  if (line.starts_with("--part ")) return UnitSelection::part(values);
  return {};
}

std::string task_arguments(StageName stage, const PlannedTask& task) {
  // The driver has looked at what the stage needs.
  std::string checked = "--inputs-checked";
  if (stage == "merge") return checked;  // all of it
  const Stage one = *std::ranges::find(all_stages, stage, stage_name);
  const std::string units = fmt::format("--{} {}", unit_option(one), unit_list(task.units));
  return one <= Stage::build ? units : units + " " + checked;
}

}  // namespace voxweld
