// The last few things loaded, shared by all threads. What is evicted lives on while someone holds
// it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <utility>

namespace voxweld {

template <class Value>
class BoundedCache {
 public:
  // capacity: values held at most, the latest asked for.
  explicit BoundedCache(std::size_t capacity) : capacity_(capacity) {}

  // The value of `key`, loaded by load() where absent. Loads run outside the lock, so that nobody
  // waits for another's value: two threads may load the same one at once, and then one is kept.
  template <class Load>
  std::shared_ptr<const Value> get(std::uint64_t key, Load&& load) {
    if (auto found = find(key)) return found;
    std::shared_ptr<const Value> value = load();
    const std::scoped_lock lock(mutex_);
    entries_.emplace_front(key, value);
    const auto [place, is_new] = places_.try_emplace(key, entries_.begin());
    if (!is_new) {
      entries_.pop_front();
      return place->second->second;
    }
    if (entries_.size() > capacity_) {
      places_.erase(entries_.back().first);
      entries_.pop_back();
    }
    return value;
  }

 private:
  using Entries = std::list<std::pair<std::uint64_t, std::shared_ptr<const Value>>>;

  std::shared_ptr<const Value> find(std::uint64_t key) {
    const std::scoped_lock lock(mutex_);
    const auto place = places_.find(key);
    if (place == places_.end()) return nullptr;
    entries_.splice(entries_.begin(), entries_, place->second);
    return place->second->second;
  }

  std::mutex mutex_;
  std::size_t capacity_;
  Entries entries_;  // latest first
  std::unordered_map<std::uint64_t, typename Entries::iterator> places_;
};

}  // namespace voxweld
