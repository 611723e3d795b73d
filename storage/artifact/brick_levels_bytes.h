// The levels of a brick (storage/types/brick_levels.h) as bytes, for octree artifacts: their lists,
// one after the other, little-endian.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "storage/types/brick_octree.h"

namespace voxweld {

struct LevelsSize {
  std::uint32_t vertices = 0, clusters = 0, merges = 0;
  std::uint64_t bytes() const {
    return std::uint64_t{vertices} * (sizeof(float) + sizeof(std::uint32_t)) +
           std::uint64_t{clusters} * sizeof(KeptCluster) +
           std::uint64_t{merges} * sizeof(BlockMerge);
  }
};

// Appends.
void put_levels(const BrickLevels& levels, std::vector<std::byte>& out);
// Precondition: bytes are as many as the size says.
BrickLevels levels_of(std::span<const std::byte> bytes, const LevelsSize& size);

}  // namespace voxweld
