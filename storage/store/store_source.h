// Reads a brick store as a volume.
#pragma once

#include <filesystem>

#include "storage/store/chunk_reader.h"
#include "storage/store/layout.h"
#include "storage/store/shard_record.h"
#include "storage/types/volume.h"

namespace voxweld {

// What a reading thread of such a store holds beyond its buffer, in bytes; the store need not be
// there yet.
std::uint64_t store_decode_bytes(const StoreLayout& layout);

// Access::box, thread-safe. Every chunk and index passes its checksum before it is used;
// DamagedArtifact names the shard file, or the record, that must be written again. Memory beyond
// info().largest_decode for each reading thread: the records cached by range(), at most 16 MiB.
class StoreSource final : public RangedSource {
 public:
  explicit StoreSource(const StoreLayout& layout);
  // Of the store that lies there (read_store_layout).
  StoreSource(const std::filesystem::path& array, const std::filesystem::path& records);

  const StoreLayout& layout() const { return layout_; }
  const VolumeInfo& info() const override { return info_; }
  void read(const Box3& box, std::byte* out) const override;

  // From the records, no sample is read: the range of all chunks that the box touches. The box is
  // cut to the volume first.
  ValueRange range(const Box3& box) const override;

 private:
  StoreLayout layout_;
  VolumeInfo info_;
  ChunkReader reader_;
  mutable BoundedCache<ShardRecord> records_;
};

}  // namespace voxweld
