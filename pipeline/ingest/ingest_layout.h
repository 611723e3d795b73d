// How ingest cuts the volume: the shards of the brick store, which are also the units where nothing
// is copied.
#pragma once

#include <vector>

#include "pipeline/ingest/ingest_stage.h"
#include "storage/store/layout.h"

namespace voxweld {

constexpr std::uint64_t ingest_band_bytes = std::uint64_t{8} << 20;  // of samples, read at once

StoreLayout store_layout(const Config& config, const IngestJob& job);
std::vector<Index3> shards_of(const StoreLayout& layout);  // x fastest

// Of a file as it is.
void feed(KeyHasher& key, const FileState& state);
// Of some of the input's files and how they are read.
Hash128 files_stamp(const IngestJob& job, std::size_t begin, std::size_t end);
// Of the input's files that samples of a box come from.
Hash128 box_stamp(const IngestJob& job, const Box3& samples);
// What a store shard is made from.
Hash128 store_shard_key(const IngestJob& job, const StoreLayout& layout, Index3 shard);

}  // namespace voxweld
