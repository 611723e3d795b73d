// Whether two octrees of bricks are the same, to the bit.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>

#include "storage/artifact/container.h"
#include "storage/artifact/node_record_bytes.h"
#include "storage/types/brick_octree.h"

namespace voxweld::testing {

template <class T>
bool same(const std::vector<T>& a, const std::vector<T>& b) {
  return std::ranges::equal(as_section(a), as_section(b));
}
inline std::vector<std::byte> bytes_of(const NodeRecord& record) {
  std::vector<std::byte> bytes;
  put_bytes(record, bytes);
  return bytes;
}

inline void expect_same(const BrickOctree& a, const BrickOctree& b) {
  EXPECT_TRUE(same(a.vertices, b.vertices));
  EXPECT_TRUE(same(a.roots, b.roots));
  EXPECT_EQ(bytes_of(a.record), bytes_of(b.record));
  EXPECT_TRUE(same(a.polygons, b.polygons));
  EXPECT_TRUE(same(a.blocks, b.blocks));
  EXPECT_TRUE(same(a.ghost.cells, b.ghost.cells));
  EXPECT_TRUE(same(a.ghost.vertices, b.ghost.vertices));
  EXPECT_TRUE(same(a.ghost.apart, b.ghost.apart));
  EXPECT_TRUE(same(a.ghost.roots, b.ghost.roots));
  EXPECT_TRUE(same(a.levels.errors, b.levels.errors));
  EXPECT_TRUE(same(a.levels.parents, b.levels.parents));
  EXPECT_TRUE(same(a.levels.clusters, b.levels.clusters));
  EXPECT_TRUE(same(a.levels.merges, b.levels.merges));
  EXPECT_TRUE(std::ranges::equal(as_record(a.root), as_record(b.root)));
  EXPECT_TRUE(std::ranges::equal(as_record(a.counts), as_record(b.counts)));
}

}  // namespace voxweld::testing
