#include "pipeline/run/task_report.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/support/provenance.h"

namespace voxweld {

TaskReport task_report(const RunContext& context, const std::string& stage) {
  TaskReport task;
  task.stage = stage;
  for (const StageReport& report : context.reports) {  // "check" and the stage itself
    task.units += report.ran;
    task.figures.wall_s += report.figures.wall_s;
    task.figures.cpu_s += report.figures.cpu_s;
    task.figures.peak_resident = std::max(task.figures.peak_resident, report.figures.peak_resident);
  }
  task.provenance = provenance_json();
  return task;
}

void write_task_report(const std::filesystem::path& path, const TaskReport& report) {
  const nlohmann::json document = {
      {"stage", report.stage},
      {"units", report.units},
      {"seconds", report.figures.wall_s},
      {"cpu_seconds", report.figures.cpu_s},
      {"peak_resident_bytes", report.figures.peak_resident},
      {"exit_code", report.exit_code},
      {"error", report.error},
      {"made_by", nlohmann::json::parse(report.provenance, nullptr, false)}};
  const std::string text =
      document.dump(1, ' ', true, nlohmann::json::error_handler_t::replace) + "\n";
  write_whole_file(path, as_bytes(text), Durability::rename_only);
}

std::optional<TaskReport> read_task_report(const std::filesystem::path& path) {
  try {
    const auto bytes = read_whole_file(path);
    const auto document =
        nlohmann::json::parse(reinterpret_cast<const char*>(bytes.data()),
                              reinterpret_cast<const char*>(bytes.data()) + bytes.size());
    TaskReport report;
    report.stage = document.at("stage");
    report.units = document.at("units");
    report.figures.wall_s = document.at("seconds");
    report.figures.cpu_s = document.at("cpu_seconds");
    report.figures.peak_resident = document.at("peak_resident_bytes");
    report.exit_code = document.at("exit_code");
    report.error = document.at("error");
    report.provenance = document.at("made_by").dump();
    return report;
  } catch (const Error&) {
    return std::nullopt;
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  }
}

}  // namespace voxweld
