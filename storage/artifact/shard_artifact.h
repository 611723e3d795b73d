// The octree artifact: what build makes of one shard. It holds the octrees of a list of materials:
// of each label (labels.mode = "each"), else of one, which is the surface, or all that labels share. An
// octree's part in one brick is a piece. Kind "octr", a container (container.h) with these sections:
//
//   name                content
//   brick code << 8 | 1 the pieces of one brick, back to back (brick_pieces.h); the code is the
//                       Morton code of the brick's index. Head and parts have a checksum each, the
//                       head in itself, the others in its PieceRecord, so they are read alone
//   2 << 56 | i         page i of the directory: PieceRecord, by material, then by brick
//   3 << 56 | i         page i of the nodes, by material, then in Morton order: of each a NodeEntry,
//                       then its CubeCount, then its TopLeaf, then where each sheet collapses by
//                       itself its NodeRecord and the links of its clusters
//   4 << 56             ShardTables (one)
//   4 << 56 | 1         PieceKey of the first piece of each page of the directory
//   4 << 56 | 2         material of the first node of each page of nodes, u64
//   as shard_summary.h  of all materials together
//
// There is no index of pieces but the directory, so a reader holds a few bytes a thousand of them,
// however many labels a shard has. Bricks without a surface have no piece there; neighbours see them
// as absent.
#pragma once

#include <functional>
#include <optional>

#include "storage/artifact/brick_pieces.h"
#include "storage/artifact/paged_table.h"
#include "storage/artifact/shard_summary.h"
#include "storage/types/material.h"
#include "storage/types/top_tree.h"

namespace voxweld {

inline constexpr std::array<char, 4> shard_kind = {'o', 'c', 't', 'r'};
// Goes up whenever build's bytes change: format or mathematics.
inline constexpr std::uint32_t shard_version = 15;

// One shard-sized cube of one material's octree. Cubes that are outside have none.
struct MaterialNode {
  Material material = exterior;
  ShardNode node;
  // Where each sheet collapses by itself: of its mesh, those that nothing above can take in.
  std::uint64_t final_vertices = 0;
  std::uint64_t largest_piece = 0;  // bytes that reading one of its pieces takes, at most
  Hash128 content;                  // of all its pieces and of node.leaves
};

std::vector<std::byte> to_bytes(const MaterialNode& node);
// Precondition: bytes of to_bytes.
MaterialNode material_node_of(std::span<const std::byte> bytes);

class ShardArtifactWriter {
 public:
  // input_stamp: of what the samples come from (container.h).
  ShardArtifactWriter(const std::filesystem::path& path, Hash128 key, Hash128 input_stamp);

  // The pieces of one brick, in any order: between begin_brick and end_brick.
  void begin_brick(std::uint64_t code);
  // blocks and above: as piece_lists.
  PieceHead piece(Material material, const BrickOctree& octree, std::span<const FilledBlock> blocks,
                  const AboveBytes& above);
  void end_brick();
  // In place of these three, what append_piece made of a brick.
  void brick(std::uint64_t code, std::span<const std::byte> pieces);
  // And all that another artifact has of a brick, and f of each piece.
  // DamagedArtifact when one fails its checks.
  void brick(std::uint64_t code, const ArtifactReader& from,
             const std::function<void(const PieceBytes&)>& f);

  // After the last piece, each in the order of the file.
  void directory(const PieceRecord& record);
  void node(const MaterialNode& node);
  // Returns the artifact's content hash.
  Hash128 finish(const ShardSummary& summary, const ShardHistory& history = {});

 private:
  void append(std::span<const std::byte> bytes);
  void flush_nodes();

  ArtifactWriter file_;
  std::uint64_t brick_ = 0, brick_bytes_ = 0;
  PagedTableWriter<PieceRecord> directory_;
  std::vector<PieceKey> first_pieces_;
  std::vector<std::byte> nodes_;  // of the page under way
  std::vector<std::uint64_t> first_nodes_;
  std::uint64_t node_count_ = 0;
};

// Reads are thread-safe.
class ShardArtifact : public OpenArtifact {
 public:
  explicit ShardArtifact(const std::filesystem::path& path);

  ShardSummary summary() const { return read_summary(file_); }
  std::uint64_t piece_count() const { return pieces_; }
  std::uint64_t node_count() const { return nodes_; }

  // The directory's part of one material, by brick: its pieces in this shard.
  std::vector<PieceRecord> pieces(Material material) const;
  // f of every piece, in the order of the directory.
  void each_piece(const std::function<void(const PieceRecord&)>& f) const;
  // What stitch reads of a brick, and of its lower neighbours' upper one. brick_level: log2 of the
  // cells a side of the shard's bricks.
  void read_piece(const PieceRecord& piece, int brick_level, BrickOctree& out) const;
  void read_ghost_layer(const PieceRecord& piece, GhostLayer& out) const;

  // What has become of the clusters of one node's bricks, where each sheet collapses by itself and
  // the material has a surface in the node.
  std::optional<ReducedNode> clusters(Material material, const CellKey& node) const;

  // Pages of the nodes, and the bytes of each node of one: by material, then in Morton order.
  std::uint64_t node_pages() const { return first_nodes_.size(); }
  void each_node(
      std::uint64_t page,
      const std::function<void(const MaterialNode&, std::span<const std::byte>)>& f) const;

 private:
  std::uint64_t pieces_ = 0, nodes_ = 0;
  std::vector<PieceKey> first_pieces_;
  std::vector<std::uint64_t> first_nodes_;
};

}  // namespace voxweld
