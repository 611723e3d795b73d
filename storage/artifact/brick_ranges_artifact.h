// The ranges of one shard's bricks, as build found them when it read all of them: the samples that the
// brick's cells touch, in the volume. The next build of the same samples, with another isovalue, reads
// no brick without a surface. Kind "rang", a container with one section:
//   1 BrickRange, ascending brick
#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "storage/support/hash.h"
#include "storage/types/volume.h"

namespace voxweld {

inline constexpr std::array<char, 4> brick_ranges_kind = {'r', 'a', 'n', 'g'};
inline constexpr std::uint32_t brick_ranges_version = 1;

struct BrickRange {
  std::uint64_t brick = 0;  // Morton code of its index
  double lo = 0, hi = 0;    // of the samples as stored
  std::uint64_t flags = 0;  // bit 0: some are NaN; bit 1: all are

  static BrickRange make(std::uint64_t brick, const ValueRange& range) {
    return {brick, range.lo, range.hi,
            static_cast<std::uint64_t>(range.any_nan) | (range.empty ? 2U : 0U)};
  }
  ValueRange range() const { return {lo, hi, (flags & 1) != 0, (flags & 2) != 0}; }
};

struct BrickRangesArtifact {
  Hash128 key, stamp;  // stamp: of what the samples come from
  std::vector<BrickRange> ranges;
};

void write_brick_ranges(const std::filesystem::path& path, const BrickRangesArtifact& artifact);
// DamagedArtifact when it fails its checks, StorageError when it cannot be read.
BrickRangesArtifact read_brick_ranges(const std::filesystem::path& path);

}  // namespace voxweld
