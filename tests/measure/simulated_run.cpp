#include "tests/measure/simulated_run.h"

#include <algorithm>

#include "pipeline/slurm/task_cost.h"
#include "pipeline/slurm/task_plan.h"

namespace voxweld {
namespace {

constexpr std::size_t merging = 2;

ClusterMachine machine_of(const SimulatedCluster& cluster) {
  ClusterMachine machine;
  machine.slots = static_cast<std::size_t>(cluster.nodes * cluster.cpus_a_node /
                                           static_cast<double>(cluster.cpus_a_task));
  machine.threads_a_task = static_cast<std::size_t>(cluster.cpus_a_task);
  machine.starts_per_s = cluster.starts_per_s;
  machine.round_trip_s = cluster.round_trip_s;
  machine.trips_per_s = cluster.trips_per_s;
  machine.stream_bytes_per_s = cluster.stream_bandwidth;
  machine.bytes_per_s = std::min(cluster.bandwidth, cluster.nodes * cluster.node_bandwidth);
  return machine;
}

// One stage, from the driver's first look to its last.
class StageSimulation {
 public:
  StageSimulation(const SimulatedWork& work, std::size_t stage, const SimulatedCluster& cluster,
                  const SimulationChoice& choice)
      : all_(work),
        work_(work.stages[stage]),
        stage_(stage),
        cluster_(cluster),
        choice_(choice),
        looks_(stage_looks[stage]),
        machine_(machine_of(cluster)) {
    result_.name = simulated_stages[stage];
    for (const MeasuredUnit& unit : work_.costs) {
      result_.cpu_s += unit.cpu_s;
      result_.files += unit.files;
      result_.read_bytes += unit.read_bytes;
      result_.written_bytes += unit.written_bytes;
    }
  }

  SimulatedStage run() {
    const std::vector<PlannedTask> plan = plan_tasks(work_.units, request());
    const std::vector<TaskLoad> tasks = loads_of(plan);
    const ArrayTimes array = simulate_array(tasks, machine_);
    describe(plan, array);

    const double before = seconds(looks_.before, all_.shards, all_.tiles);
    const double submitting = static_cast<double>(result_.arrays) *
                              (cluster_.queue_look_s + array_trips * cluster_.round_trip_s);
    const double seen = simulate_driver(array.ends, driver_of(plan));
    const double closing = seconds(looks_.closing, all_.shards, all_.tiles);
    result_.wall_s = before + submitting + seen + closing;
    const double driver = result_.wall_s - array.wall_s;
    result_.serial_s = stage_ == merging ? result_.wall_s : driver;
    const double cores = static_cast<double>(machine_.slots * machine_.threads_a_task);
    result_.ideal_s = result_.cpu_s / cores;
    result_.busy = result_.cpu_s / (result_.wall_s * cores);
    name_bound(tasks, driver);
    return std::move(result_);
  }

 private:
  TaskPlanRequest request() const {
    double weight = 0;
    for (const Unit& unit : work_.units) weight += unit.weight;
    TaskPlanRequest request;
    request.seconds_per_weight = choice_.measured_rates
                                     ? (weight > 0 ? result_.cpu_s / weight : 0)
                                     : usual_seconds_per_weight(simulated_stages[stage_]);
    request.cpus_per_task = cluster_.cpus_a_task;
    request.slots = static_cast<std::int64_t>(machine_.slots);
    return request;
  }

  std::vector<TaskLoad> loads_of(const std::vector<PlannedTask>& plan) const {
    std::vector<TaskLoad> tasks;
    for (const PlannedTask& planned : plan) {
      TaskLoad task;
      task.start = {work_.task.trips, work_.task.read_bytes + work_.task.written_bytes,
                    work_.task.cpu_s + cluster_.task_start_s};
      for (const std::uint64_t key : planned.units) {
        const MeasuredUnit& cost = work_.costs[key];
        task.units.push_back({cost.trips, cost.read_bytes + cost.written_bytes, cost.cpu_s});
      }
      if (stage_ == merging) task.start.cpu_s += seconds(looks_.inside, all_.shards, all_.tiles);
      tasks.push_back(std::move(task));
    }
    return tasks;
  }

  // Of one process that looks at so many shards and tiles.
  double seconds(const Looks& looks, double shards, double tiles) const {
    return look_seconds({looks.a_shard * shards + looks.a_tile * tiles, 0, 0}, choice_.look_threads,
                        machine_);
  }

  DriverLoad driver_of(const std::vector<PlannedTask>& plan) const {
    DriverLoad load;
    load.poll_s = std::min(cluster_.poll_s, seen_after_s);
    load.first_pause_s = std::min(load.first_pause_s, load.poll_s);
    load.look_s =
        cluster_.queue_look_s + std::min(looks_a_poll, static_cast<double>(machine_.slots)) *
                                    cluster_.round_trip_s / choice_.look_threads;
    const double units = static_cast<double>(work_.units.size());
    for (const PlannedTask& task : plan) {
      const double share = static_cast<double>(task.units.size()) / units;
      load.settle_s.push_back(seconds(looks_.after, share * all_.shards, share * all_.tiles) +
                              task_report_trips * cluster_.round_trip_s);
    }
    return load;
  }

  void describe(const std::vector<PlannedTask>& plan, const ArrayTimes& array) {
    result_.tasks = plan.size();
    result_.arrays = (plan.size() + cluster_.max_array - 1) / cluster_.max_array;
    result_.task_s = plan.empty() ? 0 : array.slot_s / static_cast<double>(plan.size());
    for (const PlannedTask& task : plan)
      result_.longest_line =
          std::max(result_.longest_line, task_arguments(simulated_stages[stage_], task).size());
    result_.files += 2 * static_cast<double>(plan.size());  // a report and a log each
    result_.read_bytes += work_.task.read_bytes * static_cast<double>(plan.size());
    result_.written_bytes += work_.task.written_bytes * static_cast<double>(plan.size());
  }

  // What would take the longest if there were nothing else.
  void name_bound(const std::vector<TaskLoad>& tasks, double driver) {
    const double cores = static_cast<double>(machine_.slots * machine_.threads_a_task);
    PieceCost sum;
    double starts_s = 0, longest_s = 0;
    for (const TaskLoad& task : tasks) {
      double own_s = 0;
      const auto add = [&](const PieceCost& piece) {
        sum.trips += piece.trips, sum.bytes += piece.bytes, sum.cpu_s += piece.cpu_s;
        return piece.cpu_s + piece.trips * machine_.round_trip_s +
               piece.bytes / machine_.stream_bytes_per_s;
      };
      for (const PieceCost& unit : task.units) own_s += add(unit);
      const double threads = static_cast<double>(machine_.threads_a_task);
      own_s = own_s / threads + add(task.start);
      sum.cpu_s -= task.start.cpu_s;
      starts_s += task.start.cpu_s;
      longest_s = std::max(longest_s, own_s);
    }
    const std::array<std::pair<double, const char*>, 8> bounds = {{
        {sum.cpu_s / cores, "cpu"},
        {starts_s / static_cast<double>(machine_.slots), "task starts"},
        {static_cast<double>(tasks.size()) / machine_.starts_per_s, "dispatch"},
        {sum.bytes / machine_.bytes_per_s, "bandwidth"},
        {sum.trips / machine_.trips_per_s, "metadata"},
        {sum.trips * machine_.round_trip_s / cores, "latency"},
        {longest_s, stage_ == merging ? "one process" : "longest task"},
        {driver, "driver"},
    }};
    result_.bound = std::max_element(bounds.begin(), bounds.end())->second;
  }

  const SimulatedWork& all_;
  const SimulatedUnits& work_;
  std::size_t stage_;
  const SimulatedCluster& cluster_;
  const SimulationChoice& choice_;
  const StageLooks& looks_;
  const ClusterMachine machine_;
  SimulatedStage result_;
};

void add(const SimulatedStage& stage, SimulatedStage& total) {
  const double slot_s = total.task_s * static_cast<double>(total.tasks) +
                        stage.task_s * static_cast<double>(stage.tasks);
  total.tasks += stage.tasks;
  total.task_s = slot_s / static_cast<double>(std::max<std::size_t>(total.tasks, 1));
  total.arrays += stage.arrays;
  total.wall_s += stage.wall_s;
  total.ideal_s += stage.ideal_s;
  total.serial_s += stage.serial_s;
  total.files += stage.files;
  total.read_bytes += stage.read_bytes;
  total.written_bytes += stage.written_bytes;
  total.cpu_s += stage.cpu_s;
  total.longest_line = std::max(total.longest_line, stage.longest_line);
}

}  // namespace

SimulatedRun simulate_run(const SimulatedWork& work, const SimulatedCluster& cluster,
                          const SimulationChoice& choice) {
  SimulatedRun run;
  run.nodes = cluster.nodes;
  for (std::size_t stage = 0; stage < stages_simulated; ++stage) {
    run.stages.push_back(StageSimulation(work, stage, cluster, choice).run());
    add(run.stages.back(), run.total);
  }
  const double cores = cluster.nodes * cluster.cpus_a_node;
  run.total.busy = run.total.cpu_s / (run.total.wall_s * cores);
  return run;
}

}  // namespace voxweld
