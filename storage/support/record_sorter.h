// Records of any size, put in order by a key of two numbers in bounded memory.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>

#include "storage/support/external_sorter.h"

namespace voxweld {

struct SortKey {
  std::uint64_t major = 0, minor = 0;
  friend auto operator<=>(const SortKey&, const SortKey&) = default;
};

struct RecordOrder {
  struct Head {
    SortKey key;
    std::uint64_t size = 0;
  };
  static bool less(const Head& a, const Head& b) { return a.key < b.key; }
  static std::uint64_t tail_bytes(const Head& head) { return head.size; }
};

class RecordSorter {
 public:
  // As ExternalSorter.
  RecordSorter(std::filesystem::path folder, std::uint64_t limit)
      : sorter_(std::move(folder), limit) {}

  void push(SortKey key, std::span<const std::byte> record) {
    sorter_.push({key, record.size()}, record);
    ++size_;
  }
  std::uint64_t size() const { return size_; }  // records pushed
  bool spilled() const { return sorter_.spilled(); }

  // After the last push: gives the records in ascending order of their keys, those of equal keys as
  // they were pushed. False after the last.
  bool next(SortKey& key, std::vector<std::byte>& record) {
    RecordOrder::Head head;
    if (!sorter_.next(head, record)) return false;
    key = head.key;
    return true;
  }
  // Forgets all, for other records.
  void clear() {
    sorter_.clear();
    size_ = 0;
  }

 private:
  ExternalSorter<RecordOrder> sorter_;
  std::uint64_t size_ = 0;
};

}  // namespace voxweld
