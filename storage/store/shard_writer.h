// Writes shards of a brick store from any source that can be read by boxes or rows.
//
// A shard is written by one caller at a time (two would lose data: the file is the unit). Different
// shards may be written by different threads, processes and hosts at once. The bytes depend on the
// layout and the samples alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "storage/store/layout.h"
#include "storage/store/shard_record.h"
#include "storage/support/hash.h"
#include "storage/types/sample_statistics.h"
#include "storage/types/volume.h"

namespace voxweld {

// Memory of one writer, reused from shard to shard. One for each thread.
struct ShardScratch {
  // How much of the source is read at once, at least one row of chunks. More is better for sources
  // whose own pieces are large.
  std::uint64_t band_bytes = std::uint64_t{32} << 20;

  std::vector<std::byte> band, chunk, encoded, index;
};

// The most memory that writing `shards` neighbouring shards in one call takes, scratch included,
// beyond the source's largest_decode and the statistics. Bytes.
std::uint64_t shard_writer_bytes(const StoreLayout& layout, std::int64_t shards,
                                 std::uint64_t band_bytes);

// Writes one shard and then its record. `key` tells later runs what it was made from.
// Preconditions: write_store_metadata accepted the layout; shard in the grid; the source has the
// layout's size and type (InputError otherwise). Throws what source.read throws; then nothing is
// left but a shard without a record.
void write_shard(const StoreLayout& layout, Index3 shard, Hash128 key, const SampleSource& source,
                 SampleStatistics& statistics, ShardScratch& scratch);

// The same for keys.size() shards from `first` on along x, written side by side: for sources that
// decode whole rows, which so are decoded once. As many files are open as shards are written.
void write_shard_row(const StoreLayout& layout, Index3 first, std::span<const Hash128> keys,
                     const SampleSource& source, SampleStatistics& statistics,
                     ShardScratch& scratch);

}  // namespace voxweld
