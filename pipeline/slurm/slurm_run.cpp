#include "pipeline/slurm/slurm_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <sstream>

#include "pipeline/slurm/command.h"
#include "storage/support/file_io.h"

namespace voxweld {

std::filesystem::path slurm_folder(const Config& config) {
  return config.work.directory / "slurm";
}

std::int64_t cluster_cpus(const std::string& partition) {
  std::vector<std::string> words = {"sinfo", "-h", "-o", "%C"};
  if (!partition.empty()) words.insert(words.end(), {"-p", partition});
  CommandOptions options;
  options.hidden_variables = {"SINFO_"};
  const CommandResult result = run_command(words, options);
  // Allocated/idle/other/total, a line where partitions differ.
  std::int64_t cpus = 0;
  std::istringstream lines(result.out);
  for (std::string line; std::getline(lines, line);) {
    long long allocated = 0, idle = 0;
    if (std::sscanf(line.c_str(), "%lld/%lld/", &allocated, &idle) == 2)
      cpus = std::max<std::int64_t>(cpus, allocated + idle);
  }
  return std::max<std::int64_t>(cpus, 1);
}

SlurmSetup set_up_slurm(const Config& config, SlurmClient& client) {
  client.version();
  SlurmSetup setup;
  setup.config = config;
  setup.folder = slurm_folder(config);
  setup.config_file = setup.folder / fmt::format("config-{}.toml",
                                                 to_hex(config_fingerprint(config)).substr(0, 12));
  write_whole_file(setup.config_file, as_bytes(canonical_toml(config)), Durability::rename_only);
  setup.program = std::filesystem::read_symlink("/proc/self/exe");
  setup.slots =
      std::max<std::int64_t>(1, cluster_cpus(config.slurm.partition) / config.slurm.cpus_per_task);
  return setup;
}

}  // namespace voxweld
