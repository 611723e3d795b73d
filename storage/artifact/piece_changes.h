// Which connected pieces of a volume a filter changes, block by block. Kind "pcch", a container with
// these sections:
//   1           the summary, as the struct below lies in memory
//   2 + block   a page of consecutive changed blocks, named for the first of them, of u64:
//                 count of blocks
//                 of each, ascending: block, then pieces (low half) and where its bits begin in
//                   words after these records (high half; all bits set: every piece changes)
//                 the bits: of each block ceil(pieces / 64) words, bit p: piece p changes
//
// Blocks of `side` samples a side begin at sample 0 and are counted x fastest, then y, then z. The
// pieces of a block are those that hang together through faces of samples within it, counted in
// order of their first samples (by z, then y, then x). Blocks without change are on no page.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "storage/artifact/container.h"
#include "storage/support/bounded_cache.h"
#include "storage/types/box.h"

namespace voxweld {

inline constexpr std::array<char, 4> piece_changes_kind = {'p', 'c', 'c', 'h'};
inline constexpr std::uint32_t piece_changes_version = 1;

struct PieceChangesSummary {
  Index3 size;              // of the volume, in samples
  std::int64_t side = 0;    // of a block
  std::uint64_t type = 0;   // position in enum SampleType
  std::uint64_t value = 0;  // what samples become: its bits as stored, then zeros
  // Pieces are made of the samples at or above the isovalue (below 1: at or below it); with
  // outside 1, of all others.
  double isovalue = 0;
  std::int64_t isovalue_rest = 0;
  std::uint64_t below = 0, outside = 0;
  std::uint64_t pieces = 0;           // that might change
  std::uint64_t changed_pieces = 0;   // that do
  std::uint64_t samples = 0;          // of those that might
  std::uint64_t changed_samples = 0;  // of those that do
  friend bool operator==(const PieceChangesSummary&, const PieceChangesSummary&) = default;
};

constexpr std::size_t piece_words(std::uint32_t pieces) {
  return (std::size_t{pieces} + 63) / 64;
}

// Memory: one page, some 160 KiB.
class PieceChangesWriter {
 public:
  PieceChangesWriter(const std::filesystem::path& path, Hash128 key);

  // bits: piece_words(pieces) of them, those beyond the pieces 0. Each block once; where the next
  // one is not behind it, a new page begins.
  void add(std::uint64_t block, std::uint32_t pieces, std::span<const std::uint64_t> bits);
  void commit(const PieceChangesSummary& summary);

 private:
  void flush();

  ArtifactWriter file_;
  std::vector<std::uint64_t> records_, words_;  // of the page under way
};

class PieceChanges : public OpenArtifact {
 public:
  // DamagedArtifact when it fails its checks, StorageError when it cannot be read.
  explicit PieceChanges(const std::filesystem::path& path);

  const PieceChangesSummary& summary() const { return summary_; }

  struct Block {
    std::uint32_t pieces = 0;
    bool all = false;  // every piece changes; `bits` is empty then
    std::span<const std::uint64_t> bits;
    std::shared_ptr<const std::vector<std::uint64_t>> page;  // where they lie
  };
  // Nothing where the block does not change. Thread-safe; holds the last few pages.
  std::optional<Block> find(std::uint64_t block) const;

  // What it holds at most, but for 40 bytes a page of the file.
  static constexpr std::uint64_t memory_bytes = std::uint64_t{16} * 160 << 10;

 private:
  std::vector<std::uint64_t> read_page(std::uint64_t name) const;

  PieceChangesSummary summary_;
  mutable BoundedCache<std::vector<std::uint64_t>> pages_{16};
};

}  // namespace voxweld
