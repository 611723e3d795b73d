#include "pipeline/ingest/store_stamps.h"

#include "storage/store/shard_record.h"
#include "storage/types/morton.h"

namespace voxweld {

Hash128 StoreStamps::of(const Box3& samples) {
  KeyHasher stamp;
  const std::int64_t side = layout_.parameters.shard;
  const Index3 lo = samples.lo, hi = samples.hi;
  for (std::int64_t z = lo.z / side; z * side < hi.z; ++z)
    for (std::int64_t y = lo.y / side; y * side < hi.y; ++y)
      for (std::int64_t x = lo.x / side; x * side < hi.x; ++x) stamp.hash(of_shard({x, y, z}));
  return stamp.finish();
}

Hash128 StoreStamps::of_shard(Index3 shard) {
  return *known_.get(morton_encode(shard), [&] {
    return std::make_shared<const Hash128>(read_shard_record(layout_, shard).file_hash);
  });
}

}  // namespace voxweld
