// Runs the units of a stage as tasks of Slurm job arrays. A task is a plain command (`voxweld build
// CONFIG --shards 0-63`) whose results are files that are complete or absent, so the truth about
// what is done is on the disk: the queue is only asked when to look. A task that fails or is lost
// is submitted again; one that runs twice does no harm.
#pragma once

#include <filesystem>

#include "pipeline/config/config.h"
#include "pipeline/executor/executor.h"
#include "pipeline/slurm/slurm_client.h"

namespace voxweld {

struct SlurmSetup {
  Config config;                      // as the tasks read it
  std::filesystem::path config_file;  // absolute, seen by the nodes; the same config
  std::filesystem::path program;      // voxweld, as the nodes find it
  std::filesystem::path folder;       // of the job arrays: scripts, logs, reports
  std::int64_t slots = 1;             // tasks the cluster runs at once, as far as is known
  double poll_s = 5;                  // between two looks at the queue, once a stage takes longer
  // How long a file that a task says it has written may stay unseen: network file systems keep what
  // they know of a folder for up to a minute.
  double visible_after_s = 60;
  // How long a task may be held in the queue, or have no prospect of a node, before it is taken for
  // failed.
  double stuck_after_s = 10;
};

class SlurmExecutor : public Executor {
 public:
  // client: lives as long as this.
  SlurmExecutor(SlurmSetup setup, SlurmClient& client);

  bool in_process() const override { return false; }
  // `work` is not called. Throws ErrorSet naming the units that could not be done, each with why
  // and the log to read; Interrupted when a stop was asked for: the tasks go on then, and a later
  // call of the same identity goes on with them.
  void run_units(StageName stage, std::span<const Unit> units, const UnitWork& work,
                 const RunOptions& options) override;

 private:
  SlurmSetup setup_;
  SlurmClient& client_;
};

}  // namespace voxweld
