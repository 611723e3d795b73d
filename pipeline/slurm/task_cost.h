// What units of a stage cost, from the reports of tasks that ran, and the scripts they run by.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "pipeline/executor/executor.h"
#include "pipeline/slurm/array_folder.h"
#include "pipeline/slurm/batch_script.h"
#include "pipeline/slurm/slurm_executor.h"
#include "pipeline/slurm/task_plan.h"

namespace voxweld {

// Of one processor, for a weight of 1 as the stage weighs its units: measured on a desktop of 2022.
double usual_seconds_per_weight(StageName stage);

// Of one processor: from the reports below `folder` where there are any of the stage, of tasks that
// held so many processors, else the usual figure. Precondition: units is not empty.
double seconds_per_weight(const std::filesystem::path& folder, StageName stage,
                          std::span<const Unit> units, std::int64_t cpus_per_task);

// As the config asks for tasks; seconds_per_weight as TaskPlanRequest has it.
TaskPlanRequest task_plan_request(const Config& config, std::int64_t slots,
                                  double seconds_per_weight);
// The tasks of units of the stage, by what its tasks have cost so far.
std::vector<PlannedTask> plan_stage_tasks(const SlurmSetup& setup, StageName stage,
                                          std::span<const Unit> units);

// An array of that many tasks, to which its commands are to be added; dependency as BatchScript has
// it.
BatchScript array_script(const SlurmSetup& setup, std::string_view name, const ArrayFolder& folder,
                         std::size_t tasks, const std::string& dependency);
// The text of one of tasks of the stage.
std::string stage_script(const SlurmSetup& setup, StageName stage, const ArrayFolder& folder,
                         std::size_t tasks, const std::string& dependency = {});

}  // namespace voxweld
