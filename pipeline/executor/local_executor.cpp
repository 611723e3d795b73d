#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <numeric>
#include <thread>
#include <vector>

#include "pipeline/executor/error_set.h"
#include "pipeline/executor/executor.h"
#include "pipeline/executor/progress.h"

namespace voxweld {
namespace {

std::vector<std::size_t> schedule(std::span<const Unit> units, UnitOrder order) {
  std::vector<std::size_t> sequence(units.size());
  std::iota(sequence.begin(), sequence.end(), std::size_t{0});
  if (order == UnitOrder::largest_first) {
    std::stable_sort(sequence.begin(), sequence.end(), [&](std::size_t a, std::size_t b) {
      if (units[a].weight != units[b].weight) return units[a].weight > units[b].weight;
      return units[a].key < units[b].key;
    });
  }
  return sequence;
}

// One stage under way: the units not yet started and what became of the others.
class StageUnderWay {
 public:
  StageUnderWay(std::span<const Unit> units, const UnitWork& work, const RunOptions& options,
                int slots)
      : units_(units),
        work_(work),
        options_(options),
        sequence_(schedule(units, options.order)),
        busy_(slots) {}

  // Takes units until none is left. Each slot's loop runs on one thread.
  void work_through(int slot) {
    take_units(slot);
    --busy_;
  }

  void finish(StageName stage) { errors_.throw_if_any(std::string(stage)); }

 private:
  void take_units(int slot) {
    WorkerContext context(slot, options_, &busy_);
    while (!stopped_.load(std::memory_order_relaxed)) {
      const std::size_t turn = next_.fetch_add(1, std::memory_order_relaxed);
      if (turn >= sequence_.size()) return;
      if (options_.interrupt != nullptr && options_.interrupt->requested()) {
        errors_.record_interrupt();
        stopped_ = true;
        return;
      }
      run_one(units_[sequence_[turn]], context);
    }
  }

  void run_one(const Unit& unit, WorkerContext& context) {
    try {
      work_(unit, context);
    } catch (...) {
      if (errors_.record_current(unit.key, unit.name)) stopped_ = true;
      return;
    }
    if (options_.progress != nullptr) options_.progress->unit_done(unit.weight, unit.apart);
  }

  std::span<const Unit> units_;
  const UnitWork& work_;
  const RunOptions& options_;
  const std::vector<std::size_t> sequence_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> stopped_{false};
  std::atomic<int> busy_;
  ErrorCollector errors_;
};

#ifdef __SANITIZE_THREAD__
// The thread sanitizer does not see how a oneTBB built without it synchronizes, and takes every
// hand-over inside it for a race. Plain threads show it our own code alone.
void on_slots(int, int slots, const std::function<void(int)>& loop) {
  std::vector<std::jthread> workers;
  for (int slot = 1; slot < slots; ++slot) workers.emplace_back(loop, slot);
  if (slots > 0) loop(0);
}
#else
// Calls `loop` once with each slot of [0, slots), on up to `threads` threads.
void on_slots(int threads, int slots, const std::function<void(int)>& loop) {
  // Without this oneTBB gives no more threads than there are cores, whatever was asked for; and
  // what units run in parallel inside stays within it too.
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  tbb::task_arena arena(threads);
  arena.execute([&] {
    tbb::parallel_for(
        0, slots,
        [&](int slot) {
          // Isolated: a thread waiting for parallel work inside a unit must not begin the loop of
          // another slot there, which would nest one unit, and its memory, in another.
          tbb::this_task_arena::isolate([&] { loop(slot); });
        },
        tbb::simple_partitioner());
  });
}
#endif

}  // namespace

void WorkerContext::add_bytes(std::uint64_t bytes) {
  if (options_.progress != nullptr) options_.progress->add_bytes(bytes);
}

void LocalExecutor::run_units(StageName stage, std::span<const Unit> units, const UnitWork& work,
                              const RunOptions& options) {
  assert(options.threads >= 1);
  const int threads = std::max(options.threads, 1);
  const int slots = static_cast<int>(std::min(units.size(), static_cast<std::size_t>(threads)));
  StageUnderWay run(units, work, options, slots);
  on_slots(threads, slots, [&](int slot) { run.work_through(slot); });
  run.finish(stage);
}

}  // namespace voxweld
