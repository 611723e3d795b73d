#include "pipeline/build/brick_ranges.h"

#include <algorithm>

#include "storage/support/error.h"
#include "storage/types/morton.h"

namespace voxweld {

void BrickRanges::open(Index3 shard, Hash128 stamp, bool read_all) {
  shard_ = shard;
  stamp_ = stamp;
  known_.reset();
  found_.clear();
  if (read_all || job_.ranges.empty()) return;
  const std::filesystem::path path = brick_ranges_path(job_, shard);
  std::error_code missing;
  if (!std::filesystem::exists(path, missing)) return;
  try {
    BrickRangesArtifact artifact = read_brick_ranges(path);
    if (artifact.key == brick_ranges_key(job_) && artifact.stamp == stamp)
      known_ = std::move(artifact.ranges);
  } catch (const Error&) {
    // The bricks are read, and it is written anew.
  }
}

std::optional<ValueRange> BrickRanges::of(Index3 brick) const {
  if (!known_) return std::nullopt;
  const std::uint64_t code = morton_encode(brick);
  const auto at = std::ranges::lower_bound(*known_, code, std::less<>(),
                                           [](const BrickRange& r) { return r.brick; });
  if (at == known_->end() || at->brick != code || at->range().any_nan) return std::nullopt;
  return at->range();
}

void BrickRanges::close() {
  const auto bricks = static_cast<std::size_t>(job_.grid.shard_bricks(shard_).count());
  if (known_ || job_.ranges.empty() || found_.size() != bricks) return;
  std::ranges::sort(found_, std::less<>(), [](const BrickRange& r) { return r.brick; });
  write_brick_ranges(brick_ranges_path(job_, shard_), {brick_ranges_key(job_), stamp_, found_});
}

}  // namespace voxweld
