// Boxes of samples out of the chunks of an array.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "storage/store/byte_store.h"
#include "storage/store/chunk_cache.h"
#include "storage/store/zarr_metadata.h"
#include "storage/support/bounded_cache.h"

namespace voxweld {

// Whose array it is decides what an unsound file means.
enum class Ownership {
  ours,    // DamagedArtifact; every file must be there, and its chunks are not kept
  theirs,  // FormatError; a missing file is fill value, and the latest chunks are kept
};

class ChunkReader {
 public:
  // The array whose metadata lie in `folder`.
  ChunkReader(ZarrArray array, StoreFolder folder, Ownership ownership);
  ~ChunkReader();
  ChunkReader(const ChunkReader&) = delete;
  ChunkReader& operator=(const ChunkReader&) = delete;

  const ZarrArray& array() const { return array_; }

  // As SampleSource::read, any box, from any thread.
  void read(const Box3& box, std::byte* out) const;
  // Calls f with each file that samples of the box lie in, be it there or not.
  void each_file(const Box3& box, const std::function<void(const std::filesystem::path&)>& f) const;

  // Bytes one call of read holds beyond `out`: a chunk, encoded and decoded, its share of the
  // chunks that are kept, and the cached indexes.
  std::uint64_t largest_decode() const;
  // Chunks decoded so far.
  std::uint64_t decoded() const { return decoded_; }

 private:
  struct Piece;    // a file, or a part of one that has an index
  struct Buffers;  // one thread's, while it reads
  struct Target {
    Box3 box;
    std::byte* out;
  };
  struct Encoded {  // where the bytes of a chunk or smaller piece lie
    std::shared_ptr<const StoredObject> object;
    ShardIndexEntry range;
  };

  std::shared_ptr<const StoredObject> open_object(Index3 at) const;
  std::shared_ptr<const Piece> open_piece(std::size_t level, Index3 at, const Encoded& bytes) const;
  void load_index(std::size_t level, Piece& piece) const;
  ShardIndexEntry find(std::size_t level, const Piece& piece, Index3 inner) const;
  void read_piece(std::size_t level, const Piece& piece, const Target& target,
                  Buffers& buffers) const;
  void read_whole_file(Index3 at, const Target& target, Buffers& buffers) const;
  template <class Locate>
  void read_chunk(Index3 at, const Locate& locate, const Target& target, Buffers& buffers) const;
  void decode(Index3 at, const Encoded& bytes, DecodedChunk& chunk, Buffers& buffers) const;
  std::span<const std::byte> take_block_header(const StoredObject& object, Index3 at,
                                               std::span<const std::byte> bytes,
                                               DecodedChunk& chunk) const;
  template <class F>
  void each_row(const Box3& part, const Target& target, const F& f) const;
  void copy_chunk(Index3 at, const DecodedChunk& chunk, const Target& target) const;
  void fill(const Box3& part, const Target& target) const;
  void read_bytes(const StoredObject& object, std::uint64_t offset, std::span<std::byte> out) const;
  [[noreturn]] void damaged(const std::string& path, const std::string& what) const;

  Box3 box_of(const Extents& extents, Index3 at) const;
  std::uint64_t grid_key(const Extents& extents, Index3 at) const;
  std::unique_ptr<Buffers> borrow_buffers() const;
  void give_back(std::unique_ptr<Buffers> buffers) const;

  ZarrArray array_;
  StoreFolder folder_;
  Ownership ownership_;
  std::size_t cached_pieces_;
  std::size_t kept_chunks_;                                           // for each thread that reads
  mutable std::vector<std::unique_ptr<BoundedCache<Piece>>> pieces_;  // of each level
  mutable ChunkCache chunks_;
  mutable std::atomic<std::uint64_t> decoded_ = 0;
  mutable std::mutex pool_mutex_;
  mutable std::vector<std::unique_ptr<Buffers>> pool_;  // never more than threads read at once
  mutable std::atomic<std::size_t> readers_ = 0;        // buffers there are
};

}  // namespace voxweld
