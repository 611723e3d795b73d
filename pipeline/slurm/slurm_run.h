// From a config to an executor on Slurm.
#pragma once

#include "pipeline/slurm/slurm_executor.h"

namespace voxweld {

// Where scripts, logs and reports of a config's job arrays are kept.
std::filesystem::path slurm_folder(const Config& config);

// Writes the config as the tasks will read it into slurm_folder() and asks Slurm how large it is.
// Precondition: work.copy is resolved. Throws InputError when Slurm's programs are missing.
SlurmSetup set_up_slurm(const Config& config, SlurmClient& client);

// What a partition ("" is the default one) has of processors that are up: at least 1.
std::int64_t cluster_cpus(const std::string& partition);

}  // namespace voxweld
