// Counts the samples of each label, in a table of bounded size.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "storage/types/label_count.h"
#include "storage/types/sample_type.h"

namespace voxweld {

class LabelTable {
 public:
  // For at most that many labels, a power of two.
  explicit LabelTable(std::size_t most);

  // The most memory a table takes, in bytes.
  static std::uint64_t memory_bytes(std::size_t most);

  // Adds the samples of `box` (native byte order, x fastest, tightly packed) from number `from` on.
  // Returns the number of the first that was not added since the table is full of other labels;
  // box.count() where all were. Samples below zero have no label and are only counted.
  // Precondition: integers; coordinates below 2^32.
  std::uint64_t add(SampleType type, const Box3& box, std::span<const std::byte> samples,
                    std::uint64_t from = 0);
  // The same for samples that were counted before; false where the table is full of other labels.
  bool add(const LabelCount& count);

  std::size_t size() const { return size_; }
  std::uint64_t negatives() const { return negatives_; }

  // All labels, ascending, until something is added or the table is cleared: then it starts anew
  // (negatives stay).
  std::span<const LabelCount> take();
  void clear();

 private:
  template <class T>
  std::uint64_t add_samples(const Box3& box, const T* samples, std::uint64_t from);
  LabelCount* place_of(std::uint64_t label);
  void grow();

  std::size_t most_;
  std::vector<LabelCount> slots_;  // open addressing; without voxels: free
  std::size_t size_ = 0;
  std::uint64_t negatives_ = 0;
  bool taken_ = false;
};

}  // namespace voxweld
