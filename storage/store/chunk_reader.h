// Boxes of samples out of the chunks of a Zarr v3 array.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "storage/store/zarr_metadata.h"
#include "storage/support/bounded_cache.h"
#include "storage/support/file_io.h"

namespace voxweld {

// Whose array it is decides what an unsound file means.
enum class Ownership {
  ours,    // DamagedArtifact; every file must be there
  theirs,  // FormatError; a missing file is fill value, as Zarr has it
};

class ChunkReader {
 public:
  ChunkReader(ZarrArray array, Ownership ownership);
  ~ChunkReader();
  ChunkReader(const ChunkReader&) = delete;
  ChunkReader& operator=(const ChunkReader&) = delete;

  const ZarrArray& array() const { return array_; }

  // As SampleSource::read, any box, from any thread.
  void read(const Box3& box, std::byte* out) const;
  // Calls f with each file that samples of the box lie in, be it there or not.
  void each_file(const Box3& box, const std::function<void(const std::filesystem::path&)>& f) const;

  // Bytes one call of read holds beyond `out`: a chunk, encoded and decoded, and the cached
  // indexes.
  std::uint64_t largest_decode() const;

 private:
  struct Shard;    // an open file and its index
  struct Buffers;  // one thread's, while it reads
  struct Target {
    Box3 box;
    std::byte* out;
  };

  std::shared_ptr<const Shard> open_file(Index3 at) const;
  std::shared_ptr<const Shard> load_file(Index3 at) const;
  void load_index(Shard& shard) const;
  void read_file(Index3 at, const Target& target, Buffers& buffers) const;
  bool load_chunk(const Shard& shard, Index3 chunk, Buffers& buffers) const;
  template <class F>
  void each_row(const Box3& part, const Target& target, const F& f) const;
  void copy_chunk(const Box3& chunk, const Target& target, const Buffers& buffers) const;
  void fill(const Box3& part, const Target& target) const;
  void read_bytes(const Shard& shard, std::uint64_t offset, std::span<std::byte> out) const;
  [[noreturn]] void damaged(const std::string& path, const std::string& what) const;

  std::unique_ptr<Buffers> borrow_buffers() const;
  void give_back(std::unique_ptr<Buffers> buffers) const;

  ZarrArray array_;
  Ownership ownership_;
  std::size_t cached_files_;
  mutable BoundedCache<Shard> files_;
  mutable std::mutex pool_mutex_;
  mutable std::vector<std::unique_ptr<Buffers>> pool_;  // never more than threads read at once
};

}  // namespace voxweld
