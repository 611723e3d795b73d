// What building one shard takes, whatever its samples are.
#pragma once

#include "stages/contouring/brick_grid.h"
#include "storage/types/material.h"
#include "storage/types/sample_type.h"

namespace voxweld {

// Bricks are read several at a time along x, as long as their samples stay under this: bytes, and
// samples where every label of them has an octree of its own.
inline constexpr std::uint64_t run_bytes = std::uint64_t{16} << 20;
inline constexpr std::uint64_t label_run_samples = std::uint64_t{1} << 18;

// Of pieces of labels, held before they go to disk.
inline constexpr std::uint64_t label_notes_bytes = std::uint64_t{8} << 20;

// Bytes of one builder at work on one shard. replaces: an edit replaces labels.
std::uint64_t shard_memory_bytes(const BrickGrid& grid, SampleType type, LabelMode labels,
                                 bool replaces);

}  // namespace voxweld
