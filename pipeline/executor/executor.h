// Runs the units of one stage. The stage says what a unit is and does; the executor decides where
// and when, so that threads of this process and tasks of a cluster serve the same pipeline.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "pipeline/executor/interrupt.h"
#include "pipeline/executor/resources.h"
#include "storage/types/nan_count.h"

namespace voxweld {

class MemoryPool;
class StageProgress;

using StageName = std::string_view;  // "ingest", "build" ...

// One independent piece of a stage's work.
struct Unit {
  std::uint64_t key = 0;  // unique in its stage; orders errors
  std::string name;       // "shard 3/0/1": how messages call it
  double weight = 1;      // expected cost, in any unit common to the stage; not negative
  // Units of one number other than 0 share a costly read: better done by one process.
  std::uint64_t together = 0;
  bool apart = false;  // named by progress, and not counted among the others
};

enum class UnitOrder {
  largest_first,  // no long unit is left to run alone at the end; equal weights in key order
  as_given,       // for sources that can only be read forwards
};

// What other processes say of the units that they ran.
struct Elsewhere {
  StageFigures figures;  // cpu_s, and the largest peak_resident
  NanCount nans;         // among the samples they read
};

struct RunOptions {
  int threads = 1;  // at least 1
  UnitOrder order = UnitOrder::largest_first;
  StageProgress* progress = nullptr;         // told of each finished unit
  const InterruptFlag* interrupt = nullptr;  // asked before each unit
  // Whether the unit's result is there and whole, whoever made it: how an executor whose units run
  // in other processes knows what is left. Asked from several threads, and not at all by one that
  // runs them itself.
  std::function<bool(const Unit&)> done;
  // Throws where going on is of no use, since the input is no longer what it was. Such an executor
  // asks it where units are said to be done and their results are not there. May be empty.
  std::function<void()> check_input;
  // What names the stage's work for such an executor: the same for the same parameters, and no
  // other. Empty: nothing of an earlier process is taken over.
  std::string identity;
  // What the units share, for work that knows only on its way what it takes. Null: nothing is
  // shared.
  std::shared_ptr<MemoryPool> memory;
  // Where an executor whose units run in other processes adds what these report.
  Elsewhere* elsewhere = nullptr;
};

// What a unit's work is given of the place it runs in.
class WorkerContext {
 public:
  // busy: how many slots' loops still take units; null: all of them.
  WorkerContext(int slot, const RunOptions& options, const std::atomic<int>* busy = nullptr)
      : slot_(slot), options_(options), busy_(busy) {}

  // In [0, threads), held by one unit at a time: the index of scratch memory that the caller owns
  // and units use again and again.
  int slot() const { return slot_; }
  // Of the threads the stage may use, those that have no unit and get none: what a unit runs in
  // parallel inside has them. Only ever grows.
  int spare_threads() const { return busy_ != nullptr ? options_.threads - busy_->load() : 0; }
  // Counts bytes towards the rate that is shown.
  void add_bytes(std::uint64_t bytes);
  // Precondition: the stage shares memory.
  const std::shared_ptr<MemoryPool>& memory() const { return options_.memory; }
  const InterruptFlag* interrupt() const { return options_.interrupt; }
  // Throws Interrupted once a stop was asked for; long units call it between their pieces.
  void check_interrupt() const {
    if (options_.interrupt != nullptr) options_.interrupt->check();
  }

 private:
  int slot_;
  const RunOptions& options_;
  const std::atomic<int>* busy_;
};

using UnitWork = std::function<void(const Unit&, WorkerContext&)>;

class Executor {
 public:
  virtual ~Executor() = default;

  // False where units run in other processes, which find out for themselves what is to be done.
  virtual bool in_process() const { return true; }

  // Runs `work` on every unit and returns when all are done. A unit that fails does not keep the
  // others from running, unless going on is of no use: a stop was asked for, or the disk is full;
  // then units under way end and no other starts.
  // `work` is called from several threads at once. An executor whose units run in other processes
  // passes the stage and the keys on, and `work` is what those processes call.
  // Throws a single failure as it came, several as ErrorSet (error_set.h) in key order, and
  // Interrupted when a stop left units undone.
  virtual void run_units(StageName stage, std::span<const Unit> units, const UnitWork& work,
                         const RunOptions& options) = 0;
};

// Threads of this process (oneTBB). Work may use oneTBB itself: a thread that waits inside a unit
// does not start another one.
class LocalExecutor : public Executor {
 public:
  void run_units(StageName stage, std::span<const Unit> units, const UnitWork& work,
                 const RunOptions& options) override;
};

}  // namespace voxweld
