// What a job array takes on a cluster: a discrete-event simulation of tasks that are started one
// after another, of their threads, and of a file system that all of them share. Pure functions.
// Sharing is processor sharing: all that wait for the file system get equal parts of it, none more
// than one stream can take.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace voxweld {

// What a piece of work needs, one after the other.
struct PieceCost {
  double trips = 0;  // round trips to the file system
  double bytes = 0;  // read and written
  double cpu_s = 0;
};

struct TaskLoad {
  PieceCost start;  // before the first unit, on one thread
  std::vector<PieceCost> units;
};

struct ClusterMachine {
  static constexpr double no_limit = std::numeric_limits<double>::infinity();

  std::size_t slots = 1;  // tasks at once
  std::size_t threads_a_task = 1;
  double starts_per_s = no_limit;  // of tasks
  double round_trip_s = 0;
  double trips_per_s = no_limit;         // of all
  double stream_bytes_per_s = no_limit;  // of one thread
  double bytes_per_s = no_limit;         // of all
};

struct ArrayTimes {
  std::vector<double> ends;  // of the tasks; the array is submitted at 0
  double wall_s = 0;
  double slot_s = 0;  // slots were taken
};

// Tasks start in their order, the first after 1 / starts_per_s.
ArrayTimes simulate_array(std::span<const TaskLoad> tasks, const ClusterMachine& machine);

// Who submitted the array and waits for it, one thing at a time.
struct DriverLoad {
  double first_pause_s = 0.25, poll_s = 5;  // pauses between two looks grow from one to the other
  double look_s = 0;                        // at the queue and at tasks that run, each time
  std::vector<double> settle_s;             // per task: to see what it has left, once it is over
};

// When the driver knows of all tasks that they are over.
double simulate_driver(std::span<const double> ends, const DriverLoad& load);

// How long one process needs for this, looking with several threads.
double look_seconds(const PieceCost& looks, double threads, const ClusterMachine& machine);

}  // namespace voxweld
