// The top tree: what merge leaves. Kind "tops", a container with these sections:
//   1  MergeCounts (one)
//   4  content hashes of the octree artifacts merged, in the Morton order of the shards
// and the tables of material_top.h: of each material the leaves above the bricks and the tile plan.
#pragma once

#include <vector>

#include "storage/artifact/material_top.h"

namespace voxweld {

inline constexpr std::array<char, 4> top_kind = {'t', 'o', 'p', 's'};
// Goes up whenever merge's bytes change.
inline constexpr std::uint32_t top_version = 10;

// What is known of the whole after merge.
struct MergeCounts {
  std::uint64_t bricks = 0, active_bricks = 0;
  std::uint64_t active_cells = 0, crossing_edges = 0;
  std::uint64_t vertices = 0;         // of the final octree
  std::uint64_t collapsed_above = 0;  // nodes above the bricks that took in their children
  std::uint64_t top_leaves = 0;       // those of them that are leaves in the end
  LeafCounts by_level;
};

class TopArtifactWriter : public MaterialTablesWriter {
 public:
  TopArtifactWriter(const std::filesystem::path& path, Hash128 key)
      : MaterialTablesWriter(path, {top_kind, top_version, key}) {}
  Hash128 finish(const MergeCounts& counts, std::span<const Hash128> shards);
};

class TopArtifact : public OpenArtifact {
 public:
  explicit TopArtifact(const std::filesystem::path& path);

  MergeCounts counts() const;
  std::vector<Hash128> shards() const;  // content hashes of what was merged
  const ArtifactReader& file() const { return file_; }
};

}  // namespace voxweld
