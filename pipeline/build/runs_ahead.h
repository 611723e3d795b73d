// Runs of a shard's bricks that other threads build, which have no shard of their own, while the
// shard's own thread is at one before. So a few shards keep all threads busy; and what is written does
// not depend on who built what.
#pragma once

#include <tbb/task_group.h>

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <span>
#include <vector>

#include "pipeline/build/run_pieces.h"

namespace voxweld {

class RunsAhead {
 public:
  // What builds one on any thread; null where nothing to do it with is free. Throws NoMemoryLeft where
  // it had to wait for memory.
  using BuildRun = std::function<std::unique_ptr<RunPieces>(const BrickRow&)>;

  // build: for helpers, empty where none may help; build_own: the same on the shard's own thread. All
  // outlive it.
  RunsAhead(std::span<const BrickRow> runs, const WorkerContext& worker, BuildRun build,
            BuildRun build_own);
  ~RunsAhead() { stop(); }
  RunsAhead(const RunsAhead&) = delete;
  RunsAhead& operator=(const RunsAhead&) = delete;

  // For the shard's own thread, once for each run, in order. The run's pieces, or null: then the
  // caller builds it. Where a helper is not done with it yet, builds others ahead meanwhile. Throws
  // what building it threw.
  std::unique_ptr<RunPieces> take(std::size_t run);
  // Forgets all that is built, so that its memory is free; nothing more is built ahead.
  void stop();

 private:
  enum class State { open, under_way, built, failed };
  struct Run {
    State state = State::open;
    std::unique_ptr<RunPieces> pieces;
    std::exception_ptr failure;
  };
  void call_helpers();
  void help();
  std::size_t next_open() const;
  bool build_one(std::size_t run, const BuildRun& build);

  std::span<const BrickRow> rows_;
  const WorkerContext& worker_;
  BuildRun build_, build_own_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Run> runs_;
  std::size_t at_ = 0;  // the shard's own thread
  int helpers_ = 0;     // called, and not done
  bool stopped_;
  tbb::task_group group_;
};

}  // namespace voxweld
