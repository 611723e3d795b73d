#include "pipeline/executor/memory_pool.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace voxweld {

bool MemoryPool::try_take(std::uint64_t bytes) {
  const std::scoped_lock lock(mutex_);
  if (!queue_.empty()) return false;
  take_back_parked(bytes);
  if (!free(bytes)) return false;
  taken_ += bytes;
  peak_ = std::max(peak_, taken_);
  return true;
}

void MemoryPool::take(std::uint64_t bytes, const InterruptFlag* interrupt) {
  // A stop is not announced to those who wait; they look for it.
  constexpr std::chrono::milliseconds between_looks{50};
  std::unique_lock lock(mutex_);
  const std::uint64_t ticket = next_ticket_++;
  queue_.push_back(ticket);
  const auto leave = [&] {
    std::erase(queue_, ticket);
    freed_.notify_all();
  };
  const auto my_turn = [&] {
    if (queue_.front() != ticket) return false;
    take_back_parked(bytes);
    return fits(bytes);
  };
  if (!my_turn()) ++waits_;
  while (!my_turn()) {
    freed_.wait_for(lock, between_looks);
    if (interrupt == nullptr || !interrupt->requested()) continue;
    leave();
    throw Interrupted();
  }
  taken_ += bytes;
  peak_ = std::max(peak_, taken_);
  leave();
}

void MemoryPool::give_back(std::uint64_t bytes) {
  if (bytes == 0) return;
  {
    const std::scoped_lock lock(mutex_);
    taken_ -= bytes;
  }
  freed_.notify_all();
}

void MemoryPool::park(MemoryShare& share) {
  {
    const std::scoped_lock lock(mutex_);
    if (share.held_ == 0) return;
    parked_.push_back(&share);
  }
  freed_.notify_all();
}

void MemoryPool::unpark(MemoryShare& share) {
  const std::scoped_lock lock(mutex_);
  std::erase(parked_, &share);
}

// With the lock held, so that no worker goes back to work in a share that is being emptied.
void MemoryPool::take_back_parked(std::uint64_t wanted) {
  while (!parked_.empty() && !free(wanted)) {
    MemoryShare& share = *parked_.front();
    parked_.erase(parked_.begin());
    share.free_buffers_();
    taken_ -= std::exchange(share.held_, 0);
  }
}

bool MemoryPool::wanted() const {
  const std::scoped_lock lock(mutex_);
  return !queue_.empty();
}

std::uint64_t MemoryPool::peak() const {
  const std::scoped_lock lock(mutex_);
  return peak_;
}

std::uint64_t MemoryPool::waits() const {
  const std::scoped_lock lock(mutex_);
  return waits_;
}

void MemoryShare::release() {
  if (held_ == 0) return;
  free_buffers_();
  pool_->give_back(held_);
  held_ = 0;
}

std::unique_ptr<MemoryLoan> MemoryLoan::attempt(MemoryPool& pool, std::uint64_t bytes) {
  if (!pool.try_take(bytes)) return nullptr;
  std::unique_ptr<MemoryLoan> loan(new MemoryLoan(pool));
  loan->bytes_ = bytes;
  return loan;
}

void MemoryShare::reserve(std::uint64_t bytes) {
  if (bytes <= held_) return;
  if (pool_->try_take(bytes - held_)) {
    held_ = bytes;
    return;
  }
  if (!may_wait_) throw NoMemoryLeft();
  if (before_waiting_) before_waiting_();
  release();
  pool_->take(bytes, interrupt_);
  held_ = bytes;
}

void MemoryShare::yield() {
  if (pool_->wanted()) release();
}

}  // namespace voxweld
