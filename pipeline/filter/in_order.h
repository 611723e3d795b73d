// Results of units that run in parallel, used one after the other in the order of the units.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <map>
#include <mutex>
#include <utility>

#include "pipeline/executor/interrupt.h"

namespace voxweld {

// Units begin in their order (UnitOrder::as_given). Thread-safe.
template <class Result>
class InOrder {
 public:
  // ahead: how many units may be begun before the first of them is used; at least one a thread.
  // use(i, result): called for each i from 0 on, by one thread at a time.
  InOrder(std::size_t ahead, const InterruptFlag* interrupt,
          std::function<void(std::size_t, Result&&)> use)
      : ahead_(ahead), interrupt_(interrupt), use_(std::move(use)) {}

  // Waits for the unit's turn. False where a unit has failed: nothing is used any more.
  // Throws Interrupted when a stop is asked for meanwhile.
  bool begin(std::size_t i) {
    std::unique_lock lock(mutex_);
    while (!failed_ && i >= next_ + ahead_) {
      // The unit that is waited for may have been stopped before it began: nobody tells of that.
      if (interrupt_ != nullptr) interrupt_->check();
      moved_.wait_for(lock, std::chrono::milliseconds(50));
    }
    return !failed_;
  }

  // Uses it, or leaves it to the thread that comes to it.
  void finish(std::size_t i, Result&& result) {
    std::unique_lock lock(mutex_);
    pending_.emplace(i, std::move(result));
    if (in_use_) return;
    in_use_ = true;
    for (auto at = pending_.find(next_); at != pending_.end() && !failed_;
         at = pending_.find(next_)) {
      Result taken = std::move(at->second);
      pending_.erase(at);
      lock.unlock();
      use_(next_, std::move(taken));  // where it throws nothing is used any more: see fail
      lock.lock();
      ++next_;
      moved_.notify_all();
    }
    in_use_ = false;
  }

  void fail() {
    const std::scoped_lock lock(mutex_);
    failed_ = true;
    moved_.notify_all();
  }

 private:
  const std::size_t ahead_;
  const InterruptFlag* const interrupt_;
  const std::function<void(std::size_t, Result&&)> use_;
  std::mutex mutex_;
  std::condition_variable moved_;
  std::map<std::size_t, Result> pending_;
  std::size_t next_ = 0;  // changed by the thread that uses alone
  bool in_use_ = false, failed_ = false;
};

}  // namespace voxweld
