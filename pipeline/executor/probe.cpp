#include "pipeline/executor/probe.h"

#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <mutex>
#include <thread>

namespace voxweld {
namespace {

constexpr std::size_t fewest_a_thread = 4;
// What a local disk answers within this time is done sooner than threads start.
constexpr std::chrono::microseconds alone{500};

using Clock = std::chrono::steady_clock;

class Probing {
 public:
  Probing(std::size_t count, const std::function<void(std::size_t)>& probe)
      : count_(count), probe_(probe) {}

  // Until none is left, or until then.
  void work_through(Clock::time_point end = Clock::time_point::max()) {
    while (Clock::now() < end) {
      const std::size_t i = next_++;
      if (i >= std::min(count_, failed_.load())) return;
      try {
        probe_(i);
      } catch (...) {
        const std::scoped_lock lock(mutex_);
        if (i >= failed_) continue;
        failed_ = i;
        error_ = std::current_exception();
      }
    }
  }

  // Those nobody has begun.
  std::size_t left() const { return count_ - std::min(count_, next_.load()); }

  void finish() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  const std::size_t count_;
  const std::function<void(std::size_t)>& probe_;
  std::atomic<std::size_t> next_{0};
  std::atomic<std::size_t> failed_{static_cast<std::size_t>(-1)};  // the lowest that did
  std::mutex mutex_;
  std::exception_ptr error_;
};

}  // namespace

void probe_all(std::size_t count, const std::function<void(std::size_t)>& probe) {
  Probing probing(count, probe);
  {
    probing.work_through(Clock::now() + alone);
    std::vector<std::jthread> threads;
    const std::size_t most = std::min(probes_at_once, probing.left() / fewest_a_thread);
    for (std::size_t t = 1; t < most; ++t)
      threads.emplace_back([&probing] { probing.work_through(); });
    probing.work_through();
  }
  probing.finish();
}

std::vector<std::size_t> probe_which(std::size_t count,
                                     const std::function<bool(std::size_t)>& holds) {
  std::vector<std::uint8_t> held(count);
  probe_all(count, [&](std::size_t i) { held[i] = holds(i) ? 1 : 0; });
  std::vector<std::size_t> which;
  for (std::size_t i = 0; i < count; ++i)
    if (held[i] != 0) which.push_back(i);
  return which;
}

}  // namespace voxweld
