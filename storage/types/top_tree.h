// What lies above the bricks: leaves that took in whole bricks, and the cubes tiles are cut from.
#pragma once

#include <cstdint>
#include <vector>

#include "storage/types/brick_octree.h"

namespace voxweld {

// A leaf above the bricks. Ascending `code` in every list.
struct TopLeaf {
  std::uint64_t code = 0;  // Morton code of its lowest finest cell
  std::uint32_t level = 0;
  LeafVertex vertex;  // leaf code unused; offset from the leaf's centre
  float residual = 0;
  std::uint32_t reserved = 0;  // no padding: leaves are written as they lie in memory

  constexpr CellKey key() const { return CellKey::of(code, level); }
};

// Vertices and polygons of one cube, a 16^3 block or larger. Vertices count where their leaf's
// lowest cell lies, polygons where their owner cell does.
struct CubeCount {
  std::uint64_t code = 0;  // Morton code of its lowest finest cell
  std::uint32_t level = 0;
  std::uint32_t vertices = 0;
  std::uint64_t polygons = 0;
};

// One shard-sized cube of the octree. A shard at the volume's upper border also builds the layer of
// bricks above it when that holds nothing but ring cells: such bricks lie in cubes of their own.
struct ShardNode {
  CellKey key;
  RootRecord record;
  std::uint64_t polygons = 0;    // when the whole cube is one leaf
  std::vector<CubeCount> cubes;  // final ones, in Morton order
  std::vector<TopLeaf> leaves;   // final ones above the bricks, in Morton order
};

// One tile of the plan.
struct PlannedTile {
  std::uint64_t code = 0;
  std::uint32_t level = 0;
  std::uint32_t reserved = 0;
  std::uint64_t vertices = 0;
  std::uint64_t polygons = 0;  // before those of fewer than three leaves are dropped

  constexpr CellKey key() const { return CellKey::of(code, level); }
};

}  // namespace voxweld
