// The top tree: the leaves above the bricks and the tile plan, as merge leaves them. Kind "tops", a
// container with these sections:
//   1              MergeCounts (one)
//   2              PlannedTile, in Morton order
//   3              code of the first leaf of each leaf section, u64
//   4              content hashes of the octree artifacts merged, in the Morton order of the shards
//   7              where each sheet collapses by itself: the links (node_record_bytes.h) of the shards'
//                  clusters to the leaves above all shards, which none of the shards has
//   0x1000000 + i  TopLeaf, in Morton order, leaves_per_section in each but the last
// With labels.mode = "each" there is one tree for each label: sections 1 and 4 are the same, the
// others as label_top.h has them, and tiles() and leaves() are not for that.
#pragma once

#include <cstdint>
#include <vector>

#include "storage/artifact/container.h"
#include "storage/types/top_tree.h"

namespace voxweld {

inline constexpr std::array<char, 4> top_kind = {'t', 'o', 'p', 's'};
inline constexpr std::uint32_t top_version = 6;

inline constexpr std::uint64_t top_counts_section = 1, top_codes_section = 3,
                               top_shards_section = 4;

// What is known of the whole after merge.
struct MergeCounts {
  std::uint64_t bricks = 0, active_bricks = 0;
  std::uint64_t active_cells = 0, crossing_edges = 0;
  std::uint64_t vertices = 0;         // of the final octree
  std::uint64_t collapsed_above = 0;  // nodes above the bricks that took in their children
  std::uint64_t top_leaves = 0;       // those of them that are leaves in the end
  double worst_residual = 0;          // of the collapsed leaves
  double worst_finest = 0;            // of the finest leaves
  std::array<std::uint64_t, max_levels + 1> leaves{};
};

// Such links as a section of this name; none where it is not there.
void write_clusters(ArtifactWriter& file, std::uint64_t section, const ReducedNode& top);
ReducedNode read_clusters(const ArtifactReader& file, std::uint64_t section);

class TopArtifactWriter {
 public:
  TopArtifactWriter(const std::filesystem::path& path, Hash128 key);
  void leaf(const TopLeaf& leaf);      // in Morton order
  void tile(const PlannedTile& tile);  // in Morton order
  void clusters(const ReducedNode& top);
  Hash128 finish(const MergeCounts& counts, std::span<const Hash128> shards);

 private:
  void flush_leaves();
  ArtifactWriter file_;
  std::vector<TopLeaf> pending_;
  std::vector<std::uint64_t> first_codes_;
  std::vector<PlannedTile> tiles_;
};

class TopArtifact : public OpenArtifact {
 public:
  explicit TopArtifact(const std::filesystem::path& path);

  bool of_labels() const { return file_.find(top_codes_section) == nullptr; }
  MergeCounts counts() const;
  std::vector<PlannedTile> tiles() const;
  std::vector<Hash128> shards() const;  // content hashes of what was merged
  // The leaves whose cubes meet the Morton range [begin, end), in order.
  std::vector<TopLeaf> leaves(std::uint64_t begin, std::uint64_t end) const;
  // Where each sheet collapses by itself: all of it but the record, and no link's root.
  ReducedNode clusters() const;
  std::uint64_t cluster_bytes() const;  // that this takes, about
  const ArtifactReader& file() const { return file_; }

 private:
  std::vector<std::uint64_t> first_codes_;
};

}  // namespace voxweld
