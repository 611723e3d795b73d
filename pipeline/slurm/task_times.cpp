#include "pipeline/slurm/task_times.h"

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>

#include "pipeline/slurm/queued_tasks.h"
#include "pipeline/slurm/slurm_run.h"
#include "storage/manifest/task_report.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

std::optional<double> time_of(const fs::path& path) {
  std::error_code error;
  const auto time = fs::last_write_time(path, error);
  if (error) return std::nullopt;
  return std::chrono::duration<double>(std::chrono::file_clock::to_sys(time).time_since_epoch())
      .count();
}

nlohmann::json made_by(const TaskReport& report) {
  nlohmann::json made = nlohmann::json::parse(report.provenance, nullptr, false);
  return made.is_object() ? made : nlohmann::json::object();
}

// "build" of the step "build-..." and of "submitted-build".
std::string stage_of_step(const std::string& step) {
  constexpr std::string_view chain = "submitted-";
  if (step.starts_with(chain)) return step.substr(chain.size());
  return step.substr(0, step.find('-'));
}

// From "... task 3 on node7: ...", the first line that the script of an array writes.
std::string node_in_log(const fs::path& log) {
  std::string text(512, '\0');
  try {
    const ReadFile file(log);
    text.resize(std::min<std::uint64_t>(file.size(), text.size()));
    file.read(0, std::as_writable_bytes(std::span(text)));
  } catch (const Error&) {
    return {};
  }
  const auto task = text.find(" task "), on = text.find(" on ", task);
  if (task == std::string::npos || on == std::string::npos) return {};
  const auto begin = on + 4, end = text.find(": ", begin);
  return end == std::string::npos ? std::string() : text.substr(begin, end - begin);
}

TaskTime reported(const TaskReport& report, const fs::path& path) {
  TaskTime time;
  const nlohmann::json made = made_by(report);
  const nlohmann::json slurm = made.value("slurm", nlohmann::json::object());
  time.stage = report.stage;
  time.node = slurm.is_object() ? slurm.value("node", made.value("host", "")) : "";
  time.ended = report.ended > 0 ? report.ended : time_of(path).value_or(0);
  time.began = time.ended - report.wall_s;
  time.failed = report.exit_code != 0;
  time.units = report.units;
  return time;
}

// Of the configs that tasks have read, those that ask for the same meshes: they may differ in how they are made.
std::vector<std::string> configs_like(const Config& config) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(slurm_folder(config), error)) {
    if (entry.path().extension() != ".toml") continue;
    try {
      Config other = load_config(entry.path());
      other.run = config.run;
      other.slurm = config.slurm;
      if (config_fingerprint(other) == config_fingerprint(config))
        names.push_back(entry.path().string());
    } catch (const Error&) {  // of an older version
    }
  }
  return names;
}

bool reads_one_of(const ArrayFolder& folder, const std::vector<std::string>& configs) {
  try {
    const std::string script = read_text_file(folder.script_path());
    return std::ranges::any_of(
        configs, [&](const std::string& name) { return script.find(name) != std::string::npos; });
  } catch (const Error&) {  // it was never submitted
    return false;
  }
}

std::vector<TaskTime> times_of(const KnownArray& array) {
  std::vector<TaskTime> times;
  const double submitted = time_of(array.folder.path() / "name").value_or(0);
  const auto count = static_cast<std::int64_t>(array.folder.tasks().size());
  for (std::int64_t task = 0; task < count; ++task) {
    const fs::path path = array.folder.report_path(task);
    std::optional<TaskTime> time;
    if (const auto report = read_task_report(path)) {
      time = reported(*report, path);
    } else if (const fs::path log = array.folder.log_path(array.job, task);
               fs::is_regular_file(log)) {
      time.emplace();
      time->node = node_in_log(log);
      time->began = time->ended = time_of(log).value_or(0);
      time->lost = true;
    }
    if (!time) continue;  // it has never begun
    if (time->stage.empty()) time->stage = stage_of_step(array.step);
    time->submitted = submitted;
    times.push_back(std::move(*time));
  }
  return times;
}

}  // namespace

std::vector<TaskTime> task_times(const Config& config) {
  std::vector<TaskTime> all;
  const std::vector<std::string> configs = configs_like(config);
  if (configs.empty()) return all;
  std::string step;
  for (const KnownArray& array : known_arrays(config)) {
    if (!reads_one_of(array.folder, configs)) continue;
    const bool again = array.step == step;
    step = array.step;
    for (TaskTime& time : times_of(array)) {
      time.again = again;
      all.push_back(std::move(time));
    }
  }
  std::ranges::stable_sort(all, {}, &TaskTime::submitted);
  return all;
}

}  // namespace voxweld
