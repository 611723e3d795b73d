// The last few things loaded, shared by all threads. What is evicted lives on while someone holds
// it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <utility>

namespace voxweld {

template <class Value>
class BoundedCache {
 public:
  explicit BoundedCache(std::size_t capacity) : capacity_(capacity) {}

  // The value of `key`, loaded by load() where absent. Loads run outside the lock: two threads may
  // load the same key at once, and then both values are good.
  template <class Load>
  std::shared_ptr<const Value> get(std::uint64_t key, Load&& load) {
    if (auto found = find(key)) return found;
    std::shared_ptr<const Value> value = load();
    const std::scoped_lock lock(mutex_);
    entries_.emplace_front(key, value);
    if (entries_.size() > capacity_) entries_.pop_back();
    return value;
  }

 private:
  std::shared_ptr<const Value> find(std::uint64_t key) {
    const std::scoped_lock lock(mutex_);
    for (auto at = entries_.begin(); at != entries_.end(); ++at)
      if (at->first == key) {
        entries_.splice(entries_.begin(), entries_, at);
        return at->second;
      }
    return nullptr;
  }

  std::mutex mutex_;
  std::size_t capacity_;
  std::list<std::pair<std::uint64_t, std::shared_ptr<const Value>>> entries_;  // latest first
};

}  // namespace voxweld
