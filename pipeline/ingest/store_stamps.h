// What tells that samples of the brick store changed.
#pragma once

#include "storage/store/layout.h"
#include "storage/support/bounded_cache.h"
#include "storage/support/hash.h"

namespace voxweld {

// Stamps of boxes of the store: of its shards that hold the samples. A shard lies under up to 27
// boxes of build, so what its record says is kept, of the shards asked for last. Thread-safe.
class StoreStamps {
 public:
  explicit StoreStamps(StoreLayout layout) : layout_(std::move(layout)) {}

  // samples: not empty, inside the volume. DamagedArtifact or StorageError for a record that cannot
  // be read.
  Hash128 of(const Box3& samples);

 private:
  static constexpr std::size_t most_known = std::size_t{1} << 16;  // of 100 bytes each
  Hash128 of_shard(Index3 shard);

  const StoreLayout layout_;
  BoundedCache<Hash128> known_{most_known};
};

}  // namespace voxweld
