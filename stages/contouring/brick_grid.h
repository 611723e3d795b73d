// How a volume's octree is cut into bricks and shards.
#pragma once

#include <cstdint>
#include <vector>

#include "storage/types/brick_octree.h"
#include "storage/types/morton.h"

namespace voxweld {

// Cells 0 .. N on each axis (N samples): the last one reaches into the ring. A layer of bricks that
// holds nothing but ring cells is built by the shard below it.
class BrickGrid {
 public:
  // size: samples a side; brick_level: log2 of the cells a side of a brick; shard: bricks a side of
  // a shard, a power of two.
  BrickGrid(Index3 size, int brick_level, int shard);

  Index3 size() const { return size_; }
  int brick_level() const { return brick_level_; }
  int shard_level() const { return shard_level_; }  // of a shard's cube
  int domain_level() const { return voxweld::domain_level(size_); }
  Index3 bricks() const { return bricks_; }  // a side, ring layers included
  Index3 shards() const { return shards_; }  // a side: build tasks

  // The bricks a shard builds, half-open.
  Box3 shard_bricks(Index3 shard) const;
  Index3 shard_of(Index3 brick) const;
  // All shards, and all shard-sized cubes with the shard that builds each, both in Morton order.
  struct Cube {
    CellKey key;
    Index3 shard;
  };
  std::vector<Index3> all_shards() const;
  std::vector<Cube> all_cubes() const;
  // Those of one shard: its own, and those of the ring layers it builds.
  std::vector<Cube> shard_cubes(Index3 shard) const;

 private:
  std::vector<Cube> cubes_within(const Box3& bricks) const;

  Index3 size_;
  int brick_level_, shard_level_;
  std::int64_t shard_;
  Index3 bricks_, shards_;
};

}  // namespace voxweld
