// A dataset cut into blocks that are read whole: its chunks, or where it has none pieces of our own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "storage/hdf5/hdf5_layouts.h"

namespace voxweld {

class DatasetBlocks {
 public:
  // Keeps the dataset of `found` open, and the file.
  DatasetBlocks(std::shared_ptr<const Hdf5File> file, FoundVolume& found);
  ~DatasetBlocks();
  DatasetBlocks(const DatasetBlocks&) = delete;
  DatasetBlocks& operator=(const DatasetBlocks&) = delete;

  // Samples a side in each dimension of the dataset; those at its end may reach beyond it.
  const std::vector<std::int64_t>& block() const { return block_; }
  std::uint64_t block_bytes() const { return block_bytes_; }
  // Bytes that load() holds beside what it returns.
  std::uint64_t scratch_bytes() const;
  const std::vector<std::byte>& fill() const { return fill_; }
  // Of chunked ones how many are stored, and how many there could be.
  std::uint64_t stored_count() const { return stored_; }
  std::uint64_t count() const { return count_; }

  // The samples of the block that begins there, in the order of the dataset, native. Null: none is
  // stored, and all are the fill value. From any thread. FormatError for damage.
  std::unique_ptr<std::byte[]> load(const std::vector<std::int64_t>& first) const;

 private:
  struct StoredChunk {
    std::vector<std::byte> bytes;
    std::uint32_t mask = 0;
  };
  std::uint64_t stored_bytes(const std::vector<std::int64_t>& first) const;
  StoredChunk read_stored(const std::vector<std::int64_t>& first) const;
  std::unique_ptr<std::byte[]> load_by_library(const std::vector<std::int64_t>& first) const;
  std::string where(const std::vector<std::int64_t>& first) const;
  void count_chunks();

  std::shared_ptr<const Hdf5File> file_;
  Hdf5Handle dataset_, memory_;
  DatasetFacts facts_;
  bool by_library_ = false;
  std::size_t width_ = 1;
  std::vector<std::int64_t> block_;
  std::uint64_t block_bytes_ = 0, stored_ = 0, count_ = 0;
  std::vector<std::byte> fill_;
};

}  // namespace voxweld
