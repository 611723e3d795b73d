// What we know of a shard besides its samples: kept beside it, written after it.
//
// Format: an artifact container (storage/artifact/container.h) of kind "shrd", version 1, whose
// key is the shard's. Sections, little-endian:
//   1  summary: file size u64, XXH3-128 of the shard file (lo u64, hi u64), chunks u64,
//      NaN samples u64, sample type u64 (position in enum SampleType)
//   2  for each inner chunk, C order (z, y, x): lowest value f64, highest value f64,
//      flags u64 (1: has NaNs, 2: no ordinary sample). Chunks outside the volume: flags 2
//   3  histogram bins u32, ascending
//   4  their counts u64
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "storage/store/layout.h"
#include "storage/support/hash.h"
#include "storage/types/histogram.h"
#include "storage/types/volume.h"

namespace voxweld {

inline constexpr std::uint32_t shard_record_version = 1;

struct ShardRecord {
  Hash128 key;  // of the inputs and parameters the shard was made from
  std::uint64_t file_size = 0;
  Hash128 file_hash;
  std::vector<ValueRange> chunks;  // C order, x fastest; all chunks of the shard
  Histogram histogram;

  ValueRange range() const;  // of the whole shard
};

void write_shard_record(const std::filesystem::path& path, const ShardRecord& record);

// DamagedArtifact where the record is missing, fails its checks or is another layout's;
// StorageError where it cannot be read.
ShardRecord read_shard_record(const StoreLayout& layout, Index3 shard);

enum class ShardCheck {
  size,     // the record is whole and the shard file has the size it says
  content,  // and the hash: reads the whole shard
};

// Whether the shard has been written with this key and is still there. Never throws for damage:
// what is not certain is not current.
bool shard_is_current(const StoreLayout& layout, Index3 shard, Hash128 key,
                      ShardCheck check = ShardCheck::size);

}  // namespace voxweld
