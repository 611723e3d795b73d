// The octree artifact: what build makes of one shard. Kind "octr", a container (container.h) with
// these sections, all little-endian arrays of the plain records of storage/types:
//
//   name                       content
//   brick code << 8 | part     of one brick with a surface; the code is the Morton code of the
//                              brick's index; part 1 LeafVertex, 2 PolygonRefs, 3 emit levels (u8,
//                              only under topology = "free"), 4 BlockCount, 5 GhostCell, 6 GhostVertex;
//                              between labels (labels.mode = "shared") also 7 MaterialPair, 8 the
//                              polygons' pairs (u32), 9 the ghost layer cells' sheets (u32); where
//                              each sheet collapses by itself (topology = "manifold") also 10 roots
//                              (u8), 11 GhostLayer::apart (u32), 12 its roots (u8), 13 the brick's
//                              NodeRecord (node_record_bytes.h), 14 the numbers of its
//                              BrickLevels::clusters and merges (u32), then the levels
//                              (brick_levels_bytes.h)
//   all ones << 8 | part       part 2 ShardNodeRecord, 3 CubeCount, 4 TopLeaf (each node's range is
//                              in its record); 1, 5 and 6 as shard_summary.h; where each sheet
//                              collapses by itself also 7 the NodeRecord of each node, 16 + n the
//                              links (put_links) of the n-th
//
// Bricks without a surface have no section; neighbours see them as absent.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "storage/artifact/shard_summary.h"
#include "storage/types/brick_octree.h"
#include "storage/types/top_tree.h"

namespace voxweld {

inline constexpr std::array<char, 4> shard_kind = {'o', 'c', 't', 'r'};
// Goes up whenever build's bytes change: format or mathematics.
inline constexpr std::uint32_t shard_version = 10;

class ShardArtifactWriter {
 public:
  // input_stamp: of what the samples come from (container.h).
  ShardArtifactWriter(const std::filesystem::path& path, Hash128 key, Hash128 input_stamp);
  // Morton code of the brick's index. Any order.
  void brick(std::uint64_t code, const BrickOctree& octree);
  // The same of a brick that another artifact has. DamagedArtifact when that fails its checks.
  void brick(std::uint64_t code, const ArtifactReader& from);
  // Nodes in Morton order. Returns the artifact's content hash.
  Hash128 finish(const ShardSummary& summary, std::span<const ShardNode> nodes,
                 const ShardHistory& history = {});

 private:
  void write_clusters(std::span<const ShardNode> nodes);

  ArtifactWriter file_;
  std::vector<std::byte> section_;
};

// Of one brick of an octree artifact.
std::vector<BlockCount> read_block_counts(const ArtifactReader& file, std::uint64_t code);
NodeRecord read_node_record(const ArtifactReader& file, std::uint64_t code);
// All of a brick but root and counts, with record and levels where each sheet collapses by itself.
// What follows takes so many bytes.
std::uint64_t brick_bytes(const ArtifactReader& file, std::uint64_t code);
void read_whole_brick(const ArtifactReader& file, std::uint64_t code, BrickOctree& out);

// Reads are thread-safe: a reader holds the index only.
class ShardArtifact : public OpenArtifact {
 public:
  explicit ShardArtifact(const std::filesystem::path& path);

  ShardSummary summary() const { return read_summary(file_); }
  // Without the links of their clusters.
  std::vector<ShardNode> nodes() const;
  // What has become of the clusters of one node's bricks, where each sheet collapses by itself and
  // the node has a surface.
  std::optional<ReducedNode> clusters(const CellKey& node) const;

  bool has_brick(std::uint64_t code) const;
  // Hashes of the parts stitch reads of its own bricks, or of neighbours (the ghost layer alone).
  void add_brick_hashes(std::uint64_t code, KeyHasher& key) const;
  void add_ghost_hashes(std::uint64_t code, KeyHasher& key) const;

  void read_brick(std::uint64_t code, BrickOctree& out) const;  // all but root and counts
  void read_ghost_layer(std::uint64_t code, GhostLayer& out) const;
  // Bytes the brick's parts take in memory.
  std::uint64_t brick_bytes(std::uint64_t code) const;

 private:
  std::vector<NodeRecord> node_records(std::size_t count) const;
};

}  // namespace voxweld
