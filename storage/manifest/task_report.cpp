#include "storage/manifest/task_report.h"

#include <nlohmann/json.hpp>

#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/support/json_text.h"

namespace voxweld {
namespace {

nlohmann::json to_json(const TaskFailure& failure) {
  nlohmann::json out = {{"message", failure.message}, {"exit_code", failure.exit_code}};
  if (failure.unit) out["unit"] = *failure.unit;
  if (!failure.damaged_path.empty()) out["damaged"] = failure.damaged_path;
  return out;
}

TaskFailure failure_of(const nlohmann::json& document) {
  TaskFailure failure;
  failure.message = document.at("message");
  failure.exit_code = document.at("exit_code");
  if (document.contains("unit")) failure.unit = document.at("unit").get<std::uint64_t>();
  failure.damaged_path = document.value("damaged", "");
  return failure;
}

nlohmann::json numbers_of(Index3 v) {
  return nlohmann::json::array({v.x, v.y, v.z});
}
Index3 index_of(const nlohmann::json& v) {
  return {v.at(0), v.at(1), v.at(2)};
}

nlohmann::json to_json(const NanCount& nans) {
  return {
      {"samples", nans.samples}, {"lo", numbers_of(nans.box.lo)}, {"hi", numbers_of(nans.box.hi)}};
}
NanCount nans_of(const nlohmann::json& document) {
  return {document.at("samples"), {index_of(document.at("lo")), index_of(document.at("hi"))}};
}

}  // namespace

void write_task_report(const std::filesystem::path& path, const TaskReport& report) {
  nlohmann::json failures = nlohmann::json::array();
  for (const TaskFailure& failure : report.failures) failures.push_back(to_json(failure));
  const nlohmann::json document = {
      {"stage", report.stage},
      {"units", report.units},
      {"seconds", report.wall_s},
      {"ended", report.ended},
      {"cpu_seconds", report.cpu_s},
      {"peak_resident_bytes", report.peak_resident},
      {"exit_code", report.exit_code},
      {"nans", to_json(report.nans)},
      {"failures", std::move(failures)},
      {"made_by", nlohmann::json::parse(report.provenance, nullptr, false)}};
  const std::string text = json_ascii_text(document, 1) + "\n";
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
    report.wall_s = document.at("seconds");
    report.ended = document.value("ended", 0.0);
    report.cpu_s = document.at("cpu_seconds");
    report.peak_resident = document.at("peak_resident_bytes");
    report.exit_code = document.at("exit_code");
    if (document.contains("nans")) report.nans = nans_of(document.at("nans"));
    for (const auto& failure : document.at("failures"))
      report.failures.push_back(failure_of(failure));
    report.provenance = json_text(document.at("made_by"));
    return report;
  } catch (const Error&) {
    return std::nullopt;
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  }
}

}  // namespace voxweld
