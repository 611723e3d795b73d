// A run of all stages on a simulated cluster, one after the other, as SlurmExecutor has it: the
// driver looks, plans tasks, submits them, and looks until all is done.
#pragma once

#include <string>

#include "tests/measure/cluster_model.h"
#include "tests/measure/simulated_work.h"
#include "tests/measure/stage_looks.h"

namespace voxweld {

struct SimulatedCluster {
  double nodes = 10;
  double cpus_a_node = 32;
  std::int64_t cpus_a_task = 4;
  std::size_t max_array = 1000;
  double starts_per_s = 60;  // a no-op array here, with slurmctld and nodes on two cores: 63
  double task_start_s =
      0.1;  // of a slot: what Slurm and the script do before and after the program
  double queue_look_s = 0.2;
  double poll_s = 5;
  double bandwidth = 100e9;       // bytes/s, of the file system
  double node_bandwidth = 3e9;    // of a node
  double stream_bandwidth = 1e9;  // of a thread
  double round_trip_s = 0.5e-3;
  double trips_per_s = 50e3;  // of the file system
};

struct SimulationChoice {
  double look_threads = voxweld::look_threads;
  bool measured_rates = true;  // what tasks reported before; else what voxweld takes for usual
};

struct SimulatedStage {
  std::string name;
  std::size_t tasks = 0, arrays = 0;
  double wall_s = 0;
  double ideal_s = 0;   // of its processor time on all processors
  double busy = 0;      // the share of them that computed
  double serial_s = 0;  // one process, or the driver, was all that worked
  double task_s = 0;    // mean
  double files = 0, read_bytes = 0, written_bytes = 0, cpu_s = 0;
  std::size_t longest_line = 0;  // of tasks.txt
  std::string bound;             // by what
};

struct SimulatedRun {
  double nodes = 0;
  std::vector<SimulatedStage> stages;
  SimulatedStage total;  // its wall_s is the makespan
};

SimulatedRun simulate_run(const SimulatedWork& work, const SimulatedCluster& cluster,
                          const SimulationChoice& choice);

}  // namespace voxweld
