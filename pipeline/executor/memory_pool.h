// Memory that the units under way share. Each says what it takes once it knows, and waits its turn
// where that would pass the budget, so that as many run at once as really fit.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "pipeline/executor/interrupt.h"

namespace voxweld {

class MemoryShare;

// Bytes handed out, first come, first served. Thread-safe.
//
// Nobody may wait while holding what the one before it waits for: a worker that has to wait gives
// back all that it can do without first (MemoryShare does), and what nobody works with is taken
// back before anybody waits.
class MemoryPool {
 public:
  explicit MemoryPool(std::uint64_t bytes) : total_(bytes) {}

  std::uint64_t total() const { return total_; }
  // At once or not at all; not at all while others wait.
  bool try_take(std::uint64_t bytes);
  // Waits until they are free. Whoever asks for more than there is gets them once nobody else has
  // any: the one who plans has made sure that one unit fits.
  // Throws Interrupted when a stop is asked for meanwhile; interrupt may be null.
  void take(std::uint64_t bytes, const InterruptFlag* interrupt);
  void give_back(std::uint64_t bytes);
  // Whether somebody waits.
  bool wanted() const;
  // The most that was handed out at a time, and how often somebody had to wait.
  std::uint64_t peak() const;
  std::uint64_t waits() const;

 private:
  friend class MemoryShare;
  bool free(std::uint64_t bytes) const { return taken_ <= total_ && bytes <= total_ - taken_; }
  bool fits(std::uint64_t bytes) const { return taken_ == 0 || free(bytes); }
  void park(MemoryShare& share);
  void unpark(MemoryShare& share);
  void take_back_parked(std::uint64_t wanted);

  const std::uint64_t total_;
  mutable std::mutex mutex_;
  std::condition_variable freed_;
  std::deque<std::uint64_t> queue_;   // tickets of those who wait
  std::vector<MemoryShare*> parked_;  // the first to be taken back first
  std::uint64_t next_ticket_ = 0;
  std::uint64_t taken_ = 0, peak_ = 0, waits_ = 0;
};

// What one piece of work takes of a pool, from its beginning to its end.
class MemoryLoan {
 public:
  // Waits as MemoryPool::take does.
  MemoryLoan(MemoryPool& pool, std::uint64_t bytes, const InterruptFlag* interrupt)
      : pool_(pool), bytes_(bytes) {
    if (bytes_ > 0) pool_.take(bytes_, interrupt);
  }
  ~MemoryLoan() { pool_.give_back(bytes_); }
  // Without waiting; null where they are not free.
  static std::unique_ptr<MemoryLoan> attempt(MemoryPool& pool, std::uint64_t bytes);
  MemoryLoan(const MemoryLoan&) = delete;
  MemoryLoan& operator=(const MemoryLoan&) = delete;

 private:
  explicit MemoryLoan(MemoryPool& pool) : pool_(pool), bytes_(0) {}

  MemoryPool& pool_;
  std::uint64_t bytes_;
};

// Thrown in place of waiting by a share that must not wait.
class NoMemoryLeft : public std::exception {
 public:
  const char* what() const noexcept override { return "no memory is left of what the units share"; }
};

// What one worker holds of a pool: it grows to the most a piece of work needed, since the worker's
// buffers do, and is given back, buffers and all, when somebody waits. Between uses it keeps both,
// until somebody needs them.
class MemoryShare {
 public:
  // free_buffers: gives the worker's buffers back to the system; called when the share is, from any
  // thread while the share is not in use.
  MemoryShare(std::shared_ptr<MemoryPool> pool, const InterruptFlag* interrupt,
              std::function<void()> free_buffers)
      : pool_(std::move(pool)), interrupt_(interrupt), free_buffers_(std::move(free_buffers)) {}
  ~MemoryShare() {
    pool_->unpark(*this);
    release();
  }
  MemoryShare(const MemoryShare&) = delete;
  MemoryShare& operator=(const MemoryShare&) = delete;

  // The time in which the worker touches its buffers; reserve and yield are for within.
  class Use {
   public:
    explicit Use(MemoryShare& share) : share_(share) { share_.pool_->unpark(share_); }
    ~Use() { share_.pool_->park(share_); }
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

   private:
    MemoryShare& share_;
  };

  // Before work that takes so many bytes, buffers included.
  void reserve(std::uint64_t bytes);
  // While it lives, reserve throws NoMemoryLeft where others would have to give something back first.
  class Hurry {
   public:
    explicit Hurry(MemoryShare& share) : share_(share) { share_.may_wait_ = false; }
    ~Hurry() { share_.may_wait_ = true; }
    Hurry(const Hurry&) = delete;
    Hurry& operator=(const Hurry&) = delete;

   private:
    MemoryShare& share_;
  };
  // While it lives, `before` is called before reserve waits, to give back what else the worker holds of
  // the pool.
  class BeforeWaiting {
   public:
    BeforeWaiting(MemoryShare& share, std::function<void()> before) : share_(share) {
      share_.before_waiting_ = std::move(before);
    }
    ~BeforeWaiting() { share_.before_waiting_ = nullptr; }
    BeforeWaiting(const BeforeWaiting&) = delete;
    BeforeWaiting& operator=(const BeforeWaiting&) = delete;

   private:
    MemoryShare& share_;
  };
  // Between two pieces of work: where others wait, lets go of everything.
  void yield();
  std::uint64_t held() const { return held_; }

 private:
  friend class MemoryPool;
  void release();

  std::shared_ptr<MemoryPool> pool_;
  const InterruptFlag* interrupt_;
  std::function<void()> free_buffers_, before_waiting_;
  std::uint64_t held_ = 0;
  bool may_wait_ = true;
};

}  // namespace voxweld
