// What an octree artifact (shard_artifact.h) says of its shard as a whole, in sections named all
// ones << 8 | part:
//
//   part 1     ShardSummaryRecord (one)
//   part 5, 6  BuiltBrick, BuiltRun: what a later build goes by
#pragma once

#include <cstdint>
#include <vector>

#include "storage/artifact/container.h"
#include "storage/types/brick_octree.h"

namespace voxweld {

constexpr std::uint64_t shard_section(std::uint64_t part) {
  return ~std::uint64_t{0} << 8 | part;
}

struct ShardSummary {
  BrickCounts counts;  // leaves and vertices: those no node above can take in
  std::uint64_t bricks = 0;
  std::uint64_t active_bricks = 0;
  std::uint64_t collapsed_above = 0;  // nodes above the bricks that took in their children
  std::uint64_t unread = 0;           // bricks left out by ranges that an earlier build had found
  Hash128 input;                      // content hash of the samples read, and of unread sides
};

// A brick that was read: what it was made from, and the counts of all its materials together.
struct BuiltBrick {
  std::uint64_t code = 0;  // Morton code of its index
  Hash128 key;             // of the parameters and of the edits that reach it
  BrickCounts counts;
};

// Bricks along x whose samples were read together.
struct BuiltRun {
  Index3 first;
  std::int64_t count = 0;
  Hash128 samples;
};

// What a later build of the same samples goes by to take over what it would make the same.
struct ShardHistory {
  std::vector<BuiltBrick> bricks;
  std::vector<BuiltRun> runs;
};

void write_summary(ArtifactWriter& file, const ShardSummary& summary);
ShardSummary read_summary(const ArtifactReader& file);
void write_history(ArtifactWriter& file, const ShardHistory& history);
ShardHistory read_history(const ArtifactReader& file);

}  // namespace voxweld
