#include "tests/measure/cluster_model.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <queue>

namespace voxweld {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();

// Customers with a demand each, served at once and equally. By virtual time: what one that has been
// here from the start would have got, so that the order of the ends is known when they come.
class SharedServer {
 public:
  SharedServer(double one, double all) : one_(one), all_(all) {}

  void join(std::size_t customer, double demand) { ends_.push({served_ + demand, customer}); }
  double next_end(double now) const {
    if (ends_.empty()) return never;
    if (rate() == never) return now;
    return now + std::max(0.0, ends_.top().first - served_) / rate();
  }
  void pass(double seconds) {
    if (!ends_.empty() && seconds > 0) served_ += seconds * rate();
  }
  std::size_t leave() {
    const auto [end, customer] = ends_.top();
    served_ = std::max(served_, end);
    ends_.pop();
    return customer;
  }

 private:
  double rate() const { return std::min(one_, all_ / static_cast<double>(ends_.size())); }

  using End = std::pair<double, std::size_t>;
  double one_, all_;
  double served_ = 0;
  std::priority_queue<End, std::vector<End>, std::greater<>> ends_;
};

// One thread of a task, on its way through a piece.
struct Worker {
  std::size_t task = 0;
  PieceCost left;
  bool starts = false;  // the task: its other threads wait
};

class ArraySimulation {
 public:
  ArraySimulation(std::span<const TaskLoad> tasks, const ClusterMachine& machine)
      : tasks_(tasks),
        machine_(machine),
        next_unit_(tasks.size()),
        threads_(tasks.size()),
        trips_(machine.round_trip_s > 0 ? 1 / machine.round_trip_s : never, machine.trips_per_s),
        bytes_(machine.stream_bytes_per_s, machine.bytes_per_s),
        cpu_(1, never) {
    times_.ends.resize(tasks.size());
  }

  ArrayTimes run() {
    for (;;) {
      SharedServer* first = &trips_;
      for (SharedServer* server : {&bytes_, &cpu_})
        if (server->next_end(now_) < first->next_end(now_)) first = server;
      const double end = first->next_end(now_), start = next_start();
      if (end == never && start == never) break;
      pass_until(std::min(end, start));
      if (start <= end)
        start_task();
      else
        go_on(first->leave());
    }
    times_.wall_s = now_;
    return std::move(times_);
  }

 private:
  double next_start() const {
    if (started_ == tasks_.size() || running_ == machine_.slots) return never;
    return std::max(now_, last_start_ + 1 / machine_.starts_per_s);
  }

  void pass_until(double then) {
    for (SharedServer* server : {&trips_, &bytes_, &cpu_}) server->pass(then - now_);
    times_.slot_s += (then - now_) * static_cast<double>(running_);
    now_ = then;
  }

  void start_task() {
    last_start_ = now_;
    ++running_;
    threads_[started_] = 1;
    workers_.push_back({started_, tasks_[started_].start, true});
    ++started_;
    go_on(workers_.size() - 1);
  }

  // Takes the worker to what its piece needs next, or to its next piece.
  void go_on(std::size_t index) {
    Worker& worker = workers_[index];
    if (worker.left.trips > 0) return enter(trips_, index, worker.left.trips);
    if (worker.left.bytes > 0) return enter(bytes_, index, worker.left.bytes);
    if (worker.left.cpu_s > 0) return enter(cpu_, index, worker.left.cpu_s);
    const std::size_t task = worker.task;
    if (worker.starts) {
      worker.starts = false;
      const std::size_t more =
          std::min(machine_.threads_a_task, std::max<std::size_t>(tasks_[task].units.size(), 1));
      for (std::size_t i = 1; i < more; ++i) {
        ++threads_[task];
        workers_.push_back({task, {}, false});
        go_on(workers_.size() - 1);
      }
    }
    if (next_unit_[task] < tasks_[task].units.size()) {
      workers_[index].left = tasks_[task].units[next_unit_[task]++];
      return go_on(index);
    }
    if (--threads_[task] > 0) return;
    times_.ends[task] = now_;
    --running_;
  }

  static void enter(SharedServer& server, std::size_t index, double& demand) {
    server.join(index, demand);
    demand = 0;
  }

  std::span<const TaskLoad> tasks_;
  const ClusterMachine& machine_;
  std::vector<std::size_t> next_unit_, threads_;  // per task
  std::vector<Worker> workers_;
  SharedServer trips_, bytes_, cpu_;
  std::size_t started_ = 0, running_ = 0;
  double now_ = 0, last_start_ = 0;
  ArrayTimes times_;
};

}  // namespace

ArrayTimes simulate_array(std::span<const TaskLoad> tasks, const ClusterMachine& machine) {
  return ArraySimulation(tasks, machine).run();
}

double simulate_driver(std::span<const double> ends, const DriverLoad& load) {
  std::vector<std::size_t> order(ends.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return ends[a] < ends[b]; });
  double now = 0, pause = load.first_pause_s;
  for (std::size_t settled = 0; settled < order.size();) {
    now += pause;
    pause = std::min(pause * 1.5, load.poll_s);
    const double asked = now;
    now += load.look_s;
    for (; settled < order.size() && ends[order[settled]] <= asked; ++settled)
      now += load.settle_s.empty() ? 0 : load.settle_s[order[settled]];
  }
  return now;
}

double look_seconds(const PieceCost& looks, double threads, const ClusterMachine& machine) {
  const double trips =
      std::max(looks.trips * machine.round_trip_s / threads, looks.trips / machine.trips_per_s);
  const double bytes = std::max(looks.bytes / machine.stream_bytes_per_s / threads,
                                looks.bytes / machine.bytes_per_s);
  return trips + bytes + looks.cpu_s / threads;
}

}  // namespace voxweld
