#include "pipeline/executor/memory_pool.h"

#include <algorithm>
#include <chrono>

namespace voxweld {

bool MemoryPool::try_take(std::uint64_t bytes) {
  const std::scoped_lock lock(mutex_);
  if (!queue_.empty() || taken_ > total_ || bytes > total_ - taken_) return false;
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
  if (queue_.front() != ticket || !fits(bytes)) ++waits_;
  while (queue_.front() != ticket || !fits(bytes)) {
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
  pool_.give_back(held_);
  held_ = 0;
}

void MemoryShare::reserve(std::uint64_t bytes) {
  if (bytes <= held_) return;
  if (pool_.try_take(bytes - held_)) {
    held_ = bytes;
    return;
  }
  release();
  pool_.take(bytes, interrupt_);
  held_ = bytes;
}

void MemoryShare::yield() {
  if (pool_.wanted()) release();
}

}  // namespace voxweld
