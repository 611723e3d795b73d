// Stopping on request: Ctrl-C and SIGTERM ask once, politely; what is finished is kept.
#pragma once

#include <atomic>

#include "storage/support/error.h"

namespace voxweld {

// Set once, by a signal handler or a test; asked by workers between pieces of work.
class InterruptFlag {
 public:
  void request() noexcept { requested_.store(true, std::memory_order_relaxed); }
  bool requested() const noexcept { return requested_.load(std::memory_order_relaxed); }
  // Throws Interrupted once a stop has been asked for.
  void check() const {
    if (requested()) throw Interrupted();
  }

 private:
  std::atomic<bool> requested_{false};
  static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");
};

// While it lives, SIGINT and SIGTERM set `flag`; a second SIGINT ends the process at once (exit
// status 130), which loses nothing: a file appears under its name only when it is whole. A repeated
// SIGTERM changes nothing, since batch systems send it to the job and to each of its steps.
// Preconditions: one at a time in a process; the flag outlives it.
// Throws StorageError when the system refuses the handler.
class InterruptScope {
 public:
  explicit InterruptScope(InterruptFlag& flag);
  ~InterruptScope();
  InterruptScope(const InterruptScope&) = delete;
  InterruptScope& operator=(const InterruptScope&) = delete;
};

}  // namespace voxweld
