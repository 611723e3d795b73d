#include "stages/contouring/brick_grid.h"

#include <algorithm>

namespace voxweld {

BrickGrid::BrickGrid(Index3 size, int brick_level, int shard)
    : size_(size), brick_level_(brick_level), shard_level_(brick_level), shard_(shard) {
  while ((1 << (shard_level_ - brick_level_)) < shard) ++shard_level_;
  const std::int64_t side = std::int64_t{1} << brick_level;
  for (int a = 0; a < 3; ++a) {
    bricks_[a] = size[a] / side + 1;
    const bool ring_only = size[a] % side == 0;
    const std::int64_t own = ring_only ? bricks_[a] - 1 : bricks_[a];
    shards_[a] = std::max<std::int64_t>(1, (own + shard - 1) / shard);
  }
}

Box3 BrickGrid::shard_bricks(Index3 shard) const {
  Box3 box;
  for (int a = 0; a < 3; ++a) {
    box.lo[a] = shard[a] * shard_;
    box.hi[a] = shard[a] + 1 == shards_[a] ? bricks_[a] : box.lo[a] + shard_;
  }
  return box;
}

Index3 BrickGrid::shard_of(Index3 brick) const {
  Index3 shard;
  for (int a = 0; a < 3; ++a) shard[a] = std::min(brick[a] / shard_, shards_[a] - 1);
  return shard;
}

std::vector<Index3> BrickGrid::all_shards() const {
  std::vector<Index3> shards;
  each_index({{}, shards_}, [&](Index3 shard) { shards.push_back(shard); });
  std::sort(shards.begin(), shards.end(),
            [](Index3 a, Index3 b) { return morton_encode(a) < morton_encode(b); });
  return shards;
}

std::vector<BrickGrid::Cube> BrickGrid::cubes_within(const Box3& bricks) const {
  std::vector<Cube> cubes;
  each_index(pieces_of(bricks, splat(shard_)), [&](Index3 cube) {
    cubes.push_back({{shard_level_, cube}, shard_of(cube * shard_)});
  });
  std::sort(cubes.begin(), cubes.end(),
            [](const Cube& a, const Cube& b) { return a.key.code() < b.key.code(); });
  return cubes;
}

std::vector<BrickGrid::Cube> BrickGrid::all_cubes() const {
  return cubes_within({{}, bricks_});
}

std::vector<BrickGrid::Cube> BrickGrid::shard_cubes(Index3 shard) const {
  return cubes_within(shard_bricks(shard));
}

}  // namespace voxweld
