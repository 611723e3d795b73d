// Counts the samples of each label in bounded memory, however many labels there are: what a table
// has no room for goes to a scratch file, sorted, and is merged at the end.
#pragma once

#include <filesystem>
#include <functional>
#include <span>

#include "stages/ingest/label_table.h"
#include "storage/support/external_sorter.h"

namespace voxweld {

class LabelTally {
 public:
  // folder: of the scratch file, which is made when needed. most: labels in memory, a power of two.
  LabelTally(std::filesystem::path folder, std::size_t most)
      : table_(most), spilled_(std::move(folder), merge_bytes) {}

  // The most memory, in bytes. Disk: 40 bytes a label, for each time the table was full and its
  // labels were others, and as much again for every factor of 64 in these times.
  static std::uint64_t memory_bytes(std::size_t most);
  // The largest `most` that takes no more than that; at least 1.
  static std::size_t labels_within(std::uint64_t bytes);

  // As LabelTable::add, all of it.
  void add(SampleType type, const Box3& box, std::span<const std::byte> samples);
  void add(const LabelCount& count);

  std::uint64_t negatives() const { return table_.negatives(); }

  // Calls f with each label once, ascending; then the tally is empty. The same whatever was added
  // in whatever order and however often the table was full.
  void finish(const std::function<void(const LabelCount&)>& f);

 private:
  static constexpr std::uint64_t merge_bytes = std::uint64_t{1} << 20;
  struct Order {
    using Head = LabelCount;
    static bool less(const LabelCount& a, const LabelCount& b) { return a.label < b.label; }
    static bool join(LabelCount& into, const LabelCount& next) {
      voxweld::add(into, next);
      return true;
    }
  };

  LabelTable table_;
  ExternalSorter<Order> spilled_;  // full tables
};

}  // namespace voxweld
