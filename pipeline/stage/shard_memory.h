// What building one shard takes.
#pragma once

#include "stages/contouring/brick_grid.h"
#include "storage/types/material.h"
#include "storage/types/sample_type.h"

namespace voxweld {

// Of the pieces of a shard, held before they go to disk.
inline constexpr std::uint64_t material_notes_bytes = std::uint64_t{8} << 20;

struct ShardMemory {
  // Of one worker, whatever the samples are: those it has read, and what a shard's own octree
  // needs.
  std::uint64_t worker = 0;
  // The most that one brick can take: the worst there is. Most take a tenth of it, and say so
  // before they do (BrickScratch::reserve).
  std::uint64_t brick = 0;
  // Bricks are read several at a time along x, as long as they have no more samples than this.
  std::uint64_t run_samples = 0;

  std::uint64_t whole() const { return worker + brick; }
};

struct ShardSurface {
  LabelMode labels = LabelMode::off;
  bool replaces = false;   // an edit replaces labels
  bool by_sheets = false;  // each sheet collapses by itself
};
ShardMemory shard_memory(const BrickGrid& grid, SampleType type, const ShardSurface& surface);

}  // namespace voxweld
