// Records put in order by a key of two numbers, in bounded memory: whenever the memory allowed is
// full its records are sorted and written to a scratch file as one run, and in the end all runs are
// merged while they are read.
//
// Based on: Knuth, "The Art of Computer Programming", volume 3, section 5.4, "External Sorting":
// one pass of k-way merging over runs as long as memory holds.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "storage/support/scratch_file.h"

namespace voxweld {

struct SortKey {
  std::uint64_t major = 0, minor = 0;
  friend auto operator<=>(const SortKey&, const SortKey&) = default;
};

class RecordSorter {
 public:
  // folder: for the scratch file, which is made only when records do not fit. limit: bytes of
  // records held at once; up to half as much again is taken, and one record of any size.
  RecordSorter(std::filesystem::path folder, std::uint64_t limit);
  ~RecordSorter();
  RecordSorter(const RecordSorter&) = delete;
  RecordSorter& operator=(const RecordSorter&) = delete;

  void push(SortKey key, std::span<const std::byte> record);
  std::uint64_t size() const { return size_; }  // records pushed
  bool spilled() const { return scratch_ != nullptr; }

  // After the last push: gives the records in ascending order of their keys, those of equal keys as
  // they were pushed. False after the last.
  bool next(SortKey& key, std::vector<std::byte>& record);
  // Forgets all, for other records.
  void clear();

 private:
  struct Entry {
    SortKey key;
    std::uint64_t offset = 0, size = 0;  // in held_
  };
  class Run;

  void sort_held();
  void spill();
  void begin_reading();
  bool comes_later(std::size_t a, std::size_t b) const;
  bool next_held(SortKey& key, std::vector<std::byte>& record);
  bool next_merged(SortKey& key, std::vector<std::byte>& record);

  std::filesystem::path folder_;
  std::uint64_t limit_;
  std::uint64_t size_ = 0;
  std::vector<std::byte> held_;
  std::vector<Entry> entries_;
  std::unique_ptr<ScratchFile> scratch_;
  std::vector<std::unique_ptr<Run>> runs_;
  std::vector<std::size_t> heap_;  // of runs by their next key, the lowest first
  std::size_t next_entry_ = 0;
  bool reading_ = false;
};

}  // namespace voxweld
