// How long a volume that nobody has at hand would take on clusters that nobody has at hand: a
// simulation from units that measure_costs.sh measured, split into tasks by voxweld's own planning.
// Prints a Markdown table for each number of nodes.
// usage: cluster_simulation COSTS[=SHARE]... [options]; --help lists them
// COSTS with SHARE 0 only says how an empty task's time grows with the number of shards.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "storage/support/error.h"
#include "tests/measure/simulated_run.h"

namespace voxweld {
namespace {

struct Arguments {
  std::vector<std::string> costs;
  std::vector<double> nodes = {10, 100, 1000};
  std::int64_t samples = 16384;
  double empty = 0;
  std::size_t patch = 512;
  std::uint64_t seed = 1;
  double look_threads = voxweld::look_threads;
  std::string rates = "measured";
  RowReads rows;
  SimulatedCluster cluster;
};

void add_options(CLI::App& app, Arguments& a) {
  SimulatedCluster& c = a.cluster;
  app.add_option("costs", a.costs, "What measure_costs.sh wrote; =SHARE of the shards")->required();
  app.add_option("--nodes", a.nodes, "A table for each")->delimiter(',')->capture_default_str();
  app.add_option("--samples", a.samples, "A side")->capture_default_str();
  app.add_option("--empty", a.empty, "Share of the shards that have no surface; the others' add up")
      ->capture_default_str();
  app.add_option("--patch", a.patch, "Neighbouring shards that are alike")->capture_default_str();
  app.add_option("--seed", a.seed)->capture_default_str();
  app.add_option("--look-threads", a.look_threads, "Threads that look")->capture_default_str();
  app.add_option("--rates", a.rates, "Planning goes by rates measured, or voxweld's usual ones")
      ->check(CLI::IsMember({"measured", "usual"}))
      ->capture_default_str();
  app.add_option("--row-trips", a.rows.trips,
                 "Round trips for each row of a shard's samples in the input; 1: a raw file whose "
                 "rows lie far apart; 0: chunks")
      ->capture_default_str();
  app.add_option("--row-bytes", a.rows.bytes, "Read for each; 4096: by pages")
      ->capture_default_str();
  app.add_option("--cpus", c.cpus_a_node, "Of a node")->capture_default_str();
  app.add_option("--cpus-per-task", c.cpus_a_task)->capture_default_str();
  app.add_option("--max-array", c.max_array)->capture_default_str();
  app.add_option("--starts", c.starts_per_s, "Tasks that Slurm starts a second")
      ->capture_default_str();
  app.add_option("--task-start", c.task_start_s, "Seconds of a slot around the program")
      ->capture_default_str();
  app.add_option("--poll", c.poll_s, "Seconds")->capture_default_str();
  app.add_option("--queue-look", c.queue_look_s, "Seconds of one squeue or sbatch")
      ->capture_default_str();
  app.add_option("--bandwidth", c.bandwidth, "Bytes/s of the file system")->capture_default_str();
  app.add_option("--node-bandwidth", c.node_bandwidth)->capture_default_str();
  app.add_option("--stream-bandwidth", c.stream_bandwidth, "Of one thread")->capture_default_str();
  app.add_option("--latency", c.round_trip_s, "Seconds of a round trip to the file system")
      ->capture_default_str();
  app.add_option("--trips", c.trips_per_s, "Round trips a second the file system serves")
      ->capture_default_str();
}

WorkMix mix_of(const Arguments& arguments) {
  WorkMix mix;
  for (const std::string& text : arguments.costs) {
    const std::size_t at = text.find('=');
    const double share = at == std::string::npos ? 1 : std::atof(text.c_str() + at + 1);
    mix.sources.push_back({read_costs(text.substr(0, at)), share});
  }
  double shares = 0;
  for (const WorkMix::Source& source : mix.sources) shares += source.share;
  if (shares <= 0) throw InputError("no costs have a share");
  for (WorkMix::Source& source : mix.sources) source.share *= (1 - arguments.empty) / shares;
  mix.empty_share = arguments.empty;
  mix.patch = arguments.patch;
  mix.seed = arguments.seed;
  mix.rows = arguments.rows;
  return mix;
}

void print_row(const SimulatedStage& s) {
  fmt::print(
      "| {} | {} | {} | {:.1f} | {:.1f} | {:.1f} | {:.0f} % | {} | {:.1f} | {:.0f} | {:.2f} | "
      "{:.2f} |\n",
      s.name, s.tasks, s.arrays, s.task_s, s.wall_s, s.ideal_s, 100 * s.busy, s.bound, s.serial_s,
      s.files, s.read_bytes / 1e12, s.written_bytes / 1e12);
}

void print_run(const SimulatedRun& run) {
  fmt::print("\n{:.0f} nodes:\n\n", run.nodes);
  fmt::print(
      "| stage | tasks | arrays | a task s | wall s | ideal s | busy | bound by | serial s | files "
      "| "
      "TB read | TB written |\n| --- | --: | --: | --: | --: | --: | --: | --- | --: | --: | --: | "
      "--: |\n");
  for (const SimulatedStage& stage : run.stages) print_row(stage);
  SimulatedStage total = run.total;
  total.name = "all";
  print_row(total);
  const double parallel_s = total.cpu_s;
  fmt::print(
      "\nMakespan {:.0f} s; serial {:.0f} s ({:.1f} %); {:.1f} core-hours of work, so no cluster "
      "is "
      "more than {:.0f} times as fast as one processor (Amdahl); longest line of tasks.txt {} "
      "bytes.\n",
      total.wall_s, total.serial_s, 100 * total.serial_s / total.wall_s, parallel_s / 3600,
      (parallel_s + total.serial_s) / total.serial_s, total.longest_line);
}

void print_summary(const std::vector<SimulatedRun>& runs) {
  fmt::print(
      "\n| nodes | makespan s | serial s | share | core-hours | files | TB read | TB "
      "written |\n| --: | --: | --: | --: | --: | --: | --: | --: |\n");
  for (const SimulatedRun& run : runs)
    fmt::print("| {:.0f} | {:.0f} | {:.0f} | {:.0f} % | {:.1f} | {:.0f} | {:.1f} | {:.1f} |\n",
               run.nodes, run.total.wall_s, run.total.serial_s,
               100 * run.total.serial_s / run.total.wall_s, run.total.cpu_s / 3600, run.total.files,
               run.total.read_bytes / 1e12, run.total.written_bytes / 1e12);
}

// Wall time over ideal, from the fewest nodes to the most.
void print_break(const std::vector<SimulatedRun>& runs) {
  if (runs.size() < 2) return;
  const auto by_nodes = [](const SimulatedRun& a, const SimulatedRun& b) {
    return a.nodes < b.nodes;
  };
  const auto [few, many] = std::minmax_element(runs.begin(), runs.end(), by_nodes);
  std::size_t breaks = 0, costs = 0;
  double worst = 0;
  for (std::size_t s = 0; s < many->stages.size(); ++s) {
    const SimulatedStage &a = few->stages[s], &b = many->stages[s];
    const double growth = (b.wall_s / b.ideal_s) / (a.wall_s / a.ideal_s);
    // Merge is one task: it never gains from nodes, so it would always be the one.
    if (b.tasks > 1 && growth > worst) worst = growth, breaks = s;
    if (b.wall_s - b.ideal_s > many->stages[costs].wall_s - many->stages[costs].ideal_s) costs = s;
  }
  const SimulatedStage &a = few->stages[breaks], &b = many->stages[breaks];
  fmt::print(
      "\nBreaks first: {} (wall / ideal {:.3g} on {:.0f} nodes, {:.3g} on {:.0f}; there bound by "
      "{}). "
      "Loses most on {:.0f} nodes: {} ({:.0f} s beyond ideal, bound by {}).\n",
      b.name, a.wall_s / a.ideal_s, few->nodes, b.wall_s / b.ideal_s, many->nodes, b.bound,
      many->nodes, many->stages[costs].name,
      many->stages[costs].wall_s - many->stages[costs].ideal_s, many->stages[costs].bound);
}

void simulate(const Arguments& arguments) {
  const SimulatedWork work = draw_work(mix_of(arguments), arguments.samples);
  fmt::print("{}^3 samples: {:.0f} shards, {:.0f} tiles, {:.3g} vertices\n", arguments.samples,
             work.shards, work.tiles, work.vertices);
  const SimulationChoice choice{arguments.look_threads, arguments.rates == "measured"};
  std::vector<SimulatedRun> runs;
  for (const double nodes : arguments.nodes) {
    SimulatedCluster cluster = arguments.cluster;
    cluster.nodes = nodes;
    runs.push_back(simulate_run(work, cluster, choice));
    print_run(runs.back());
  }
  print_summary(runs);
  print_break(runs);
}

}  // namespace
}  // namespace voxweld

int main(int argc, char** argv) {
  CLI::App app("A volume on a cluster, simulated from measured units");
  voxweld::Arguments arguments;
  voxweld::add_options(app, arguments);
  CLI11_PARSE(app, argc, argv);
  try {
    voxweld::simulate(arguments);
    return 0;
  } catch (const voxweld::Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return error.exit_code();
  }
}
