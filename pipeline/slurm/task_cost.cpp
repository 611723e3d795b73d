#include "pipeline/slurm/task_cost.h"

#include <fmt/format.h>

#include "storage/manifest/task_report.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t enough_reports = 200;

}  // namespace

// A sample, a brick with a surface, a vertex or polygon (also of a pass of refine, or of a survey of it),
// a polygon.
double usual_seconds_per_weight(StageName stage) {
  if (stage == "ingest") return 1e-8;
  if (stage == "build") return 0.005;
  if (stage == "stitch") return 5e-7;
  if (stage == "refine" || stage == "seams") return 5e-6;
  if (stage == "mend" || stage == "remend") return 1e-6;
  if (stage == "survey" || stage == "recount") return 1e-5;
  if (stage == "retile") return 1e-6;
  if (stage == "encode") return 2e-6;
  return 0;
}

double seconds_per_weight(const fs::path& folder, StageName stage, std::span<const Unit> units,
                          std::int64_t cpus_per_task) {
  const auto cpus = static_cast<double>(cpus_per_task);
  double busy_s = 0, weight = 0;
  std::uint64_t done = 0;
  std::size_t read = 0;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (!entry.path().filename().string().starts_with(std::string(stage) + "-")) continue;
    for (const ArrayFolder& array : ArrayFolder::all(entry.path()))
      for (const auto& file : fs::directory_iterator(array.reports(), error)) {
        if (read == enough_reports) break;
        const auto report = read_task_report(file.path());
        if (!report || report->units == 0) continue;
        // Waiting for the file system takes the slot's time too.
        busy_s += std::max(report->cpu_s, report->wall_s * cpus);
        done += report->units;
        ++read;
      }
  }
  if (done == 0) return usual_seconds_per_weight(stage);
  for (const Unit& unit : units) weight += unit.weight;
  if (weight <= 0) return 0;
  return busy_s / static_cast<double>(done) * static_cast<double>(units.size()) / weight;
}

TaskPlanRequest task_plan_request(const Config& config, std::int64_t slots,
                                  double seconds_per_weight) {
  TaskPlanRequest request;
  request.seconds_per_weight = seconds_per_weight;
  request.cpus_per_task = config.slurm.cpus_per_task;
  request.slots = slots;
  request.units_per_task = config.slurm.shards_per_task;
  return request;
}

std::vector<PlannedTask> plan_stage_tasks(const SlurmSetup& setup, StageName stage,
                                          std::span<const Unit> units) {
  const double seconds = units.empty() ? 0
                                       : seconds_per_weight(setup.folder, stage, units,
                                                            setup.config.slurm.cpus_per_task);
  return plan_tasks(units, task_plan_request(setup.config, setup.slots, seconds));
}

BatchScript array_script(const SlurmSetup& setup, std::string_view name, const ArrayFolder& folder,
                         std::size_t tasks, const std::string& dependency) {
  BatchScript script = batch_script(setup.config);
  script.name = fmt::format("voxweld-{}", name);
  script.log = log_pattern(folder.logs(), true);
  script.array =
      BatchScript::Array{static_cast<std::int64_t>(tasks), setup.config.slurm.max_running};
  script.dependency = dependency;
  return script;
}

std::string stage_script(const SlurmSetup& setup, StageName stage, const ArrayFolder& folder,
                         std::size_t tasks, const std::string& dependency) {
  BatchScript script = array_script(setup, stage, folder, tasks, dependency);
  script.body =
      array_body(folder.tasks_path(),
                 std::array{setup.program.string(), std::string(stage), setup.config_file.string(),
                            std::string("--set"),
                            fmt::format("run.threads={}", setup.config.slurm.cpus_per_task),
                            std::string("--report"), folder.reports().string()});
  return render(script);
}

}  // namespace voxweld
