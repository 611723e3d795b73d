#include "pipeline/slurm/slurm_status.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "pipeline/run/stages.h"
#include "pipeline/slurm/task_plan.h"
#include "storage/manifest/task_report.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr std::uint64_t longest_log = std::uint64_t{64} << 10;  // shown of one task

// The stages in order, as far as what lies there tells.
void look_at_results(RunContext& context, RunStatus& status) {
  for (const Stage stage : stages_of(context.config))
    status.stages.push_back({stage, stage == Stage::merge ? "trees" : unit_option(stage)});
  Stages stages(context);
  for (StageState& state : status.stages) {
    const StageLook look = stages.open(state.stage).look({});
    state.units = look.units;
    state.there = look.units - look.to_do().size();
    state.known = true;
    if (!look.current()) return;
  }
  status.finished = true;
}

void look_at_queue(const std::vector<KnownArray>& arrays, SlurmClient& client, RunStatus& status) {
  for (const QueuedTasks& queued : queued_tasks(arrays, client)) {
    if (!queued.alive()) continue;
    QueuedArray entry;
    entry.array = queued.array;
    for (const TaskState& task : queued.tasks) {
      if (task.state == TaskState::gone) continue;
      const bool pending = task.state == TaskState::pending;
      ++(pending ? entry.pending : entry.running);
      auto& words = pending ? entry.reasons : entry.nodes;
      const std::string& word = pending ? task.reason : task.node;
      if (std::find(words.begin(), words.end(), word) == words.end()) words.push_back(word);
    }
    std::sort(entry.nodes.begin(), entry.nodes.end());
    status.queue.push_back(std::move(entry));
  }
  std::sort(status.queue.begin(), status.queue.end(),
            [](const QueuedArray& a, const QueuedArray& b) { return a.array.job < b.array.job; });
}

std::string log_text(const std::filesystem::path& path) {
  const ReadFile file(path);
  const std::uint64_t size = std::min(file.size(), longest_log);
  std::string text(size, '\0');
  file.read(file.size() - size, std::as_writable_bytes(std::span(text.data(), text.size())));
  return fmt::format("==> {}{}\n{}\n", path.string(), size < file.size() ? " (its end)" : "", text);
}

}  // namespace

std::vector<FailedTask> failed_tasks(const Config& config) {
  std::vector<KnownArray> arrays = known_arrays(config);
  // One that was not submitted repeats nothing of those before it.
  std::erase_if(arrays, [](const KnownArray& array) { return array.job == 0; });
  std::vector<FailedTask> failed;
  for (std::size_t i = 0; i < arrays.size(); ++i) {
    if (i + 1 < arrays.size() && arrays[i + 1].step == arrays[i].step) continue;
    const std::size_t tasks = arrays[i].folder.tasks().size();
    for (std::size_t t = 0; t < tasks; ++t) {
      const auto task = static_cast<std::int64_t>(t);
      const auto report = read_task_report(arrays[i].folder.report_path(task));
      if (!report || report->exit_code == 0) continue;
      failed.push_back({arrays[i], task,
                        report->failures.empty() ? "" : report->failures.front().message,
                        arrays[i].folder.log_path(arrays[i].job, task)});
    }
  }
  return failed;
}

RunStatus run_status(RunContext& context, SlurmClient& client) {
  RunStatus status;
  const std::vector<KnownArray> arrays = known_arrays(context.config);
  try {
    look_at_queue(arrays, client, status);
  } catch (const Interrupted&) {
    throw;
  } catch (const Error& error) {
    status.queue_unknown = error.what();
  }
  status.failed = failed_tasks(context.config);
  look_at_results(context, status);
  return status;
}

std::string to_text(const RunStatus& status) {
  std::string text;
  for (const StageState& stage : status.stages) {
    text += fmt::format("{:<7} ", stage_name(stage.stage));
    if (!stage.known)
      text += "waits\n";
    else if (stage.units == 0)
      text += "nothing to do\n";
    else
      text += fmt::format("{} of {} {}\n", stage.there, stage.units, stage.noun);
  }
  for (const QueuedArray& entry : status.queue) {
    text += fmt::format("job {} ({}):", entry.array.job, entry.array.step);
    if (entry.running > 0)
      text += fmt::format(" {} running on {}", entry.running, fmt::join(entry.nodes, ", "));
    if (entry.pending > 0)
      text += fmt::format("{} {} pending ({})", entry.running > 0 ? "," : "", entry.pending,
                          fmt::join(entry.reasons, ", "));
    text += "\n";
  }
  for (const FailedTask& task : status.failed)
    text += fmt::format("task {}_{} ({}) failed: {}\n  log: {}\n", task.array.job, task.task,
                        task.array.step, task.why, task.log.string());
  if (!status.queue_unknown.empty()) text += "the queue: " + status.queue_unknown + "\n";
  text += status.finished   ? "finished\n"
          : status.queued() ? "under way\n"
                            : "not finished, and nothing in the queue\n";
  return text;
}

nlohmann::json to_json(const RunStatus& status) {
  nlohmann::json out = {{"finished", status.finished},
                        {"stages", nlohmann::json::array()},
                        {"queue", nlohmann::json::array()},
                        {"failed", nlohmann::json::array()}};
  for (const StageState& stage : status.stages) {
    nlohmann::json entry = {{"stage", stage_name(stage.stage)}};
    if (stage.known) entry.update({{"units", stage.units}, {"done", stage.there}});
    out["stages"].push_back(entry);
  }
  for (const QueuedArray& entry : status.queue)
    out["queue"].push_back({{"job", entry.array.job},
                            {"step", entry.array.step},
                            {"running", entry.running},
                            {"pending", entry.pending},
                            {"nodes", entry.nodes},
                            {"reasons", entry.reasons}});
  for (const FailedTask& task : status.failed)
    out["failed"].push_back({{"job", task.array.job},
                             {"step", task.array.step},
                             {"task", task.task},
                             {"why", task.why},
                             {"log", task.log.string()}});
  if (!status.queue_unknown.empty()) out["queue_unknown"] = status.queue_unknown;
  return out;
}

std::string task_logs(const Config& config, const RunStatus& status,
                      std::optional<std::uint64_t> unit) {
  std::string text;
  if (!unit) {
    for (const FailedTask& task : status.failed)
      if (std::filesystem::is_regular_file(task.log)) text += log_text(task.log);
    return text;
  }
  for (const KnownArray& array : known_arrays(config)) {
    const std::vector<std::string> lines = array.folder.tasks();
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const auto log = array.folder.log_path(array.job, static_cast<std::int64_t>(i));
      if (task_selection(lines[i]).contains(*unit) && std::filesystem::is_regular_file(log))
        text += log_text(log);
    }
  }
  return text;
}

}  // namespace voxweld
