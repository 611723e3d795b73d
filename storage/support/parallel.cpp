#include "storage/support/parallel.h"

#ifndef __SANITIZE_THREAD__
#include <tbb/parallel_for.h>
#include <tbb/task_group.h>

#include <deque>
#include <mutex>
#include <optional>
#include <vector>
#endif

namespace voxweld {

void for_each_index(std::size_t count, const std::function<void(std::size_t)>& f) {
#ifdef __SANITIZE_THREAD__
  // The thread sanitizer does not see how a oneTBB built without it synchronizes.
  for (std::size_t i = 0; i < count; ++i) f(i);
#else
  if (count == 1) return f(0);
  tbb::parallel_for(std::size_t{0}, count, f, tbb::simple_partitioner());
#endif
}

#ifndef __SANITIZE_THREAD__
namespace {

// Numbers start as what is there allows. Nothing ever waits for that, as a thread that waited could be the
// one that is waited for: what has been put starts the next.
class OrderedRun {
 public:
  OrderedRun(const OrderedWork& work, std::size_t slots, std::size_t most)
      : work_(work), most_(most), states_(slots) {
    for (std::size_t slot = slots; slot-- > 0;) free_.push_back(slot);
  }

  void run() {
    {
      const std::scoped_lock lock(mutex_);
      start();
    }
    group_.wait();
  }

 private:
  struct State {
    std::size_t number = 0, size = 0;
    bool done = false;
  };

  // Precondition of these two: the lock is held.
  void start() {
    for (; started_ < work_.count && !free_.empty(); ++started_) {
      const std::size_t size = work_.size(started_);
      if (put_ < started_ && (taken_ > most_ || size > most_ - taken_)) return;
      const std::size_t slot = free_.back();
      free_.pop_back();
      taken_ += size;
      states_[slot] = {started_, size, false};
      waiting_.push_back(slot);
      group_.run([this] { work(); });
    }
  }
  std::optional<std::size_t> next_to_put() const {
    for (std::size_t slot = 0; slot < states_.size(); ++slot)
      if (states_[slot].done && states_[slot].number == put_) return slot;
    return std::nullopt;
  }

  // The first that nobody works on: that which is put next is waited for the most.
  void work() {
    std::size_t slot = 0, number = 0;
    {
      const std::scoped_lock lock(mutex_);
      slot = waiting_.front();
      waiting_.pop_front();
      number = states_[slot].number;
    }
    work_.work(number, slot);
    std::unique_lock lock(mutex_);
    states_[slot].done = true;
    if (putting_) return;  // who does that looks again
    putting_ = true;
    while (const auto next = next_to_put()) {
      lock.unlock();
      work_.put(put_, *next);
      lock.lock();
      ++put_;
      taken_ -= states_[*next].size;
      states_[*next].done = false;
      free_.push_back(*next);
      start();
    }
    putting_ = false;
  }

  const OrderedWork& work_;
  const std::size_t most_;
  std::mutex mutex_;
  std::vector<State> states_;        // of slots
  std::vector<std::size_t> free_;    // slots
  std::deque<std::size_t> waiting_;  // slots, by number
  std::size_t started_ = 0, put_ = 0, taken_ = 0;
  bool putting_ = false;
  tbb::task_group group_;
};

}  // namespace
#endif

void for_each_in_order(const OrderedWork& work, std::size_t slots, std::size_t most) {
#ifdef __SANITIZE_THREAD__
  static_cast<void>(slots), static_cast<void>(most);
  for (std::size_t i = 0; i < work.count; ++i) {
    work.work(i, 0);
    work.put(i, 0);
  }
#else
  OrderedRun(work, slots, most).run();
#endif
}

}  // namespace voxweld
