// The chunks of a foreign array that were decoded last, shared by all threads: neighbouring boxes
// have chunks in common. Who asks for a chunk that another is decoding waits for it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <vector>

namespace voxweld {

// The samples of one chunk in native byte order, or that there are none.
struct DecodedChunk {
  std::vector<std::byte> samples;
  std::vector<std::int64_t> shape;  // of each dimension of the array
  bool missing = false;             // all of it is fill value
};

class ChunkCache {
 public:
  // The chunk of `key`, by load(DecodedChunk&) where it is not held. load() sets all of it but
  // `missing`, which is false; its vectors may hold what they held before. Holds `capacity` chunks at most
  // then, the latest asked for, besides those that are in use.
  template <class Load>
  std::shared_ptr<const DecodedChunk> get(std::uint64_t key, std::size_t capacity, Load&& load) {
    const std::shared_ptr<Entry> entry = place(key, std::max<std::size_t>(1, capacity));
    const std::scoped_lock lock(entry->mutex);
    if (!entry->loaded) {
      entry->chunk.missing = false;
      load(entry->chunk);
      entry->loaded = true;
    }
    return {entry, &entry->chunk};
  }

 private:
  struct Entry {
    std::mutex mutex;  // held while it is loaded
    bool loaded = false;
    DecodedChunk chunk;
  };
  using Entries = std::list<std::pair<std::uint64_t, std::shared_ptr<Entry>>>;

  std::shared_ptr<Entry> place(std::uint64_t key, std::size_t capacity) {
    const std::scoped_lock lock(mutex_);
    const auto found = places_.find(key);
    if (found != places_.end()) {
      entries_.splice(entries_.begin(), entries_, found->second);
      return entries_.front().second;
    }
    auto entry = std::make_shared<Entry>();
    for (; entries_.size() >= capacity; entries_.pop_back()) {
      places_.erase(entries_.back().first);
      // Nobody else holds it: its memory is used again.
      if (auto& last = entries_.back().second; last.use_count() == 1)
        std::swap(entry->chunk, last->chunk);
    }
    entries_.emplace_front(key, std::move(entry));
    places_[key] = entries_.begin();
    return entries_.front().second;
  }

  std::mutex mutex_;
  Entries entries_;  // latest first
  std::unordered_map<std::uint64_t, typename Entries::iterator> places_;
};

}  // namespace voxweld
