#include "pipeline/slurm/queued_tasks.h"

#include <algorithm>
#include <map>

#include "pipeline/slurm/slurm_run.h"

namespace voxweld {

std::vector<KnownArray> arrays_of_step(const std::filesystem::path& step) {
  std::vector<KnownArray> arrays;
  for (const ArrayFolder& folder : ArrayFolder::all(step))
    arrays.push_back({step.filename().string(), folder, folder.job().value_or(0)});
  return arrays;
}

std::vector<KnownArray> known_arrays(const Config& config) {
  std::vector<std::filesystem::path> steps;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(slurm_folder(config), error))
    if (entry.is_directory(error)) steps.push_back(entry.path());
  std::sort(steps.begin(), steps.end());
  std::vector<KnownArray> arrays;
  for (const auto& step : steps)
    for (KnownArray& array : arrays_of_step(step)) arrays.push_back(std::move(array));
  return arrays;
}

bool QueuedTasks::alive() const {
  return std::any_of(tasks.begin(), tasks.end(),
                     [](const TaskState& task) { return task.state != TaskState::gone; });
}

std::vector<QueuedTasks> queued_tasks(const std::vector<KnownArray>& arrays, SlurmClient& client) {
  std::vector<std::int64_t> jobs;
  std::vector<std::string> names, names_alone;
  for (const KnownArray& array : arrays) {
    names.push_back(array.folder.name());
    if (names.back().empty()) continue;
    if (array.job != 0)
      jobs.push_back(array.job);
    else
      names_alone.push_back(names.back());
  }
  std::map<std::string, std::map<std::int64_t, std::vector<TaskState>>> found;  // by name and id
  for (TaskState& task : client.tasks(jobs)) found[task.name][task.job].push_back(task);
  for (TaskState& task : client.tasks_named(names_alone))
    found[task.name][task.job].push_back(task);

  std::vector<QueuedTasks> queued;
  for (std::size_t i = 0; i < arrays.size(); ++i) {
    const auto at = names[i].empty() ? found.end() : found.find(names[i]);
    if (at == found.end()) continue;
    for (auto& [job, tasks] : at->second) {
      queued.push_back({arrays[i], std::move(tasks)});
      queued.back().array.job = job;
    }
  }
  return queued;
}

}  // namespace voxweld
