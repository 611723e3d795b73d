// Counts the samples of each label in bounded memory, however many labels there are: what a table
// has no room for goes to a scratch file, sorted, and is merged at the end.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "stages/ingest/label_table.h"
#include "storage/support/scratch_file.h"

namespace voxweld {

class LabelTally {
 public:
  // folder: of the scratch file, which is made when needed. most: labels in memory, a power of two.
  LabelTally(std::filesystem::path folder, std::size_t most);

  // The most memory, in bytes. Disk: 40 bytes a label, for each time the table was full and its
  // labels were others, and as much again for every factor of 16 in these times.
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
  struct Run {  // of sorted counts in the file
    std::uint64_t offset = 0, count = 0;
    int level = 0;  // how often its counts were merged
  };
  class Reader;

  void spill();
  void merge_last(int level);
  void merge(std::span<const Run> runs, std::span<const LabelCount> more,
             const std::function<void(const LabelCount&)>& f) const;

  std::filesystem::path folder_;
  LabelTable table_;
  std::unique_ptr<ScratchFile> file_;
  std::vector<Run> runs_;  // levels fall
};

}  // namespace voxweld
