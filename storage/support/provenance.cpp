#include "storage/support/provenance.h"

#include <fmt/chrono.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <ctime>
#include <nlohmann/json.hpp>

#include "storage/support/host.h"
#include "storage/support/json_text.h"

namespace voxweld {
namespace {

std::string config_fingerprint, kernels;  // as they were told

nlohmann::json slurm_ids() {
  constexpr std::array<std::array<const char*, 2>, 5> names = {
      {{"job", "SLURM_JOB_ID"},
       {"array_job", "SLURM_ARRAY_JOB_ID"},
       {"array_task", "SLURM_ARRAY_TASK_ID"},
       {"node", "SLURMD_NODENAME"},
       {"restarts", "SLURM_RESTART_COUNT"}}};
  nlohmann::json ids;
  for (const auto& [name, variable] : names)
    if (const char* value = std::getenv(variable)) ids[name] = value;
  return ids;
}

}  // namespace

void set_provenance_config(Hash128 fingerprint) {
  config_fingerprint = to_hex(fingerprint);
}

void set_provenance_kernels(std::string_view name) {
  kernels = name;
}

std::string provenance_json() {
  nlohmann::json made = {{"program", "voxweld " VOXWELD_VERSION},
                         {"host", host_name()},
                         {"process", getpid()},
                         {"time", fmt::format("{:%FT%TZ}", fmt::gmtime(std::time(nullptr)))}};
  if (!kernels.empty()) made["kernels"] = kernels;
  if (!config_fingerprint.empty()) made["config"] = config_fingerprint;
  if (const nlohmann::json ids = slurm_ids(); !ids.empty()) made["slurm"] = ids;
  return json_ascii_text(made);
}

}  // namespace voxweld
