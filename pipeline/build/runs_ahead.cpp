#include "pipeline/build/runs_ahead.h"

#include <algorithm>

namespace voxweld {

RunsAhead::RunsAhead(std::span<const BrickRow> runs, const WorkerContext& worker, BuildRun build,
                     BuildRun build_own)
    : rows_(runs),
      worker_(worker),
      build_(std::move(build)),
      build_own_(std::move(build_own)),
      runs_(runs.size()),
      stopped_(!build_) {}

std::unique_ptr<RunPieces> RunsAhead::take(std::size_t run) {
  std::unique_lock lock(mutex_);
  at_ = run;
  Run& own = runs_[run];
  if (own.state == State::open) own.state = State::built;  // by the caller
  call_helpers();
  while (own.state == State::under_way) {
    const std::size_t other = next_open();
    if (stopped_ || other == runs_.size()) {
      changed_.wait(lock);
      continue;
    }
    runs_[other].state = State::under_way;
    lock.unlock();
    build_one(other, build_own_);
    lock.lock();
  }
  if (own.state == State::failed) std::rethrow_exception(own.failure);
  return std::move(own.pieces);
}

void RunsAhead::stop() {
  {
    const std::scoped_lock lock(mutex_);
    stopped_ = true;
  }
  group_.wait();  // those that have not begun find that there is nothing to do
  for (Run& run : runs_) {
    if (run.state == State::built && run.pieces) run.state = State::open;
    run.pieces.reset();
  }
}

// With the lock held.
void RunsAhead::call_helpers() {
  const int spare = worker_.spare_threads();
  while (!stopped_ && helpers_ < spare && next_open() < runs_.size()) {
    if (helpers_ >= static_cast<int>(runs_.size() - at_)) return;
    ++helpers_;
    group_.run([this] { help(); });
  }
}

// No further ahead than keeps the helpers busy: what they build waits in memory.
std::size_t RunsAhead::next_open() const {
  const std::size_t end = std::min(
      runs_.size(), at_ + 2 * static_cast<std::size_t>(std::max(worker_.spare_threads(), 0)) + 1);
  for (std::size_t i = at_; i < end; ++i)
    if (runs_[i].state == State::open) return i;
  return runs_.size();
}

void RunsAhead::help() {
  for (bool goes_on = true; goes_on;) {
    std::size_t run = 0;
    {
      const std::scoped_lock lock(mutex_);
      run = next_open();
      if (stopped_ || run == runs_.size()) break;
      runs_[run].state = State::under_way;
    }
    goes_on = build_one(run, build_);
  }
  const std::scoped_lock lock(mutex_);
  --helpers_;
}

// Whether it was built.
bool RunsAhead::build_one(std::size_t run, const BuildRun& build) {
  std::unique_ptr<RunPieces> pieces;
  std::exception_ptr failure;
  bool no_memory = false;
  try {
    pieces = build(rows_[run]);
  } catch (const NoMemoryLeft&) {
    no_memory = true;  // the shard's own thread builds it, and waits where it must
  } catch (...) {
    failure = std::current_exception();
  }
  const bool built = pieces != nullptr;
  {
    const std::scoped_lock lock(mutex_);
    Run& at = runs_[run];
    if (failure) {
      at.state = State::failed;
      at.failure = failure;
    } else {
      // One that the shard's own thread waits for is its own then.
      at.state = built || run == at_ ? State::built : State::open;
      at.pieces = std::move(pieces);
    }
    stopped_ = stopped_ || no_memory;
  }
  changed_.notify_all();
  return built;
}

}  // namespace voxweld
