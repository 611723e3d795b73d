// What is kept of one submitted job array: <parent>/array-NNN with
//   tasks.txt   the arguments of task N on line N + 1
//   job.sh      the script as it was submitted
//   name        the job's name, unique; written before it is submitted
//   job         the id Slurm gave it; missing when the submission was cut short, also when whoever
//               submitted it died before writing it: then Slurm knows the job by its name
//   logs/       <array job>_<task>.log     reports/   <task>.json (storage/manifest/task_report.h)
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace voxweld {

class ArrayFolder {
 public:
  ArrayFolder() = default;
  explicit ArrayFolder(std::filesystem::path path) : path_(std::move(path)) {}
  // The next free one below `parent`, with its folders, tasks.txt and name.
  static ArrayFolder create(const std::filesystem::path& parent,
                            const std::vector<std::string>& tasks, const std::string& name);
  // Those below `parent`, oldest first; none where there is no such folder.
  static std::vector<ArrayFolder> all(const std::filesystem::path& parent);

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path tasks_path() const { return path_ / "tasks.txt"; }
  std::filesystem::path script_path() const { return path_ / "job.sh"; }
  std::filesystem::path logs() const { return path_ / "logs"; }
  std::filesystem::path reports() const { return path_ / "reports"; }
  std::filesystem::path report_path(std::int64_t task) const;
  // The newest log of the task; the folder of all where there is none.
  std::filesystem::path log_path(std::int64_t job, std::int64_t task) const;

  std::vector<std::string> tasks() const;
  std::string name() const;  // empty where the folder was left unfinished
  std::optional<std::int64_t> job() const;
  void set_job(std::int64_t job) const;

 private:
  std::filesystem::path path_;
};

}  // namespace voxweld
