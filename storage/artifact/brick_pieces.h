// Pieces: the octree of one material in one brick, as it lies in the brick's section of an octree
// artifact (shard_artifact.h). A surface is one material. Behind the head come three parts, lists of
// the plain records of storage/types, little-endian:
//
//   body   LeafVertex, PolygonRefs, of FilledBlock those that hold anything; under topology = "free"
//          the emit levels (u8); between labels (labels.mode = "shared") MaterialPair and the
//          polygons' pairs (u32); where each sheet collapses by itself (topology = "manifold") the
//          roots (u8)
//   ghost  GhostCell, GhostVertex; between labels the cells' sheets (u32); where each sheet collapses
//          by itself GhostLayer::apart (u32) and the roots (u8)
//   above  where each sheet collapses by itself the NodeRecord (node_record_bytes.h) and the levels
//          (brick_levels_bytes.h); stitch does not read it
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "storage/artifact/container.h"
#include "storage/types/brick_octree.h"
#include "storage/types/material.h"

namespace voxweld {

struct PieceKey {
  Material material = exterior;
  std::uint64_t brick = 0;  // Morton code of its index
  friend auto operator<=>(const PieceKey&, const PieceKey&) = default;
};

struct PieceRecord {
  PieceKey key;
  std::uint64_t offset = 0;  // of the body in the brick's section; the others come behind it
  std::uint32_t vertices = 0, polygons = 0, blocks = 0, ghost_cells = 0, ghost_vertices = 0;
  // Where each sheet collapses by itself, else 0: GhostLayer::apart, the bytes of the NodeRecord,
  // and the vertices that nothing above the brick can take in.
  std::uint32_t apart = 0, record_bytes = 0, final_vertices = 0;
  // And of its levels: BrickLevels::clusters and merges.
  std::uint32_t kept_clusters = 0, block_merges = 0;
  std::uint32_t pairs = 0;  // between labels
  std::uint32_t lists = 0;  // bit 0: there are emit levels, bit 1: the ghost cells' sheets
  Hash128 body, ghost, above;

  bool by_sheets() const { return record_bytes != 0; }
  std::uint64_t body_bytes() const;
  std::uint64_t ghost_bytes() const;
  std::uint64_t above_bytes() const;
  std::uint64_t stitched_bytes() const { return body_bytes() + ghost_bytes(); }
  std::uint64_t bytes() const { return stitched_bytes() + above_bytes(); }
};

// A material that fills a brick has nothing but a head there; the directory leaves it out.
struct PieceHead {
  PieceRecord piece;
  RootRecord root;
};

// The section of a brick's pieces, by the Morton code of its index.
constexpr std::uint64_t pieces_section(std::uint64_t brick) {
  return brick << 8 | 1;
}

// The head, as it lies in the file.
std::vector<std::byte> head_bytes(const PieceHead& head);

// Record and levels; nothing where sheets do not collapse by themselves.
struct AboveBytes {
  std::vector<std::byte> bytes;
  std::size_t record_bytes = 0;  // of them the first
  std::span<const std::byte> record() const { return std::span(bytes).first(record_bytes); }
};
void put_above(const BrickOctree& octree, AboveBytes& out);

// A piece as it is written: its head, and its lists in their order, in the memory they were given in.
struct PieceLists {
  PieceHead head;
  std::vector<std::span<const std::byte>> lists;
};
// key, offset: where the piece is to lie; the offset is that of its head. blocks:
// filled_blocks(octree.blocks). above: of put_above. All three live longer than the result.
PieceLists piece_lists(const PieceKey& key, std::uint64_t offset, const BrickOctree& octree,
                       std::span<const FilledBlock> blocks, const AboveBytes& above);

// The same to the end of the section of its brick so far.
PieceHead append_piece(const PieceKey& key, const BrickOctree& octree,
                       std::span<const FilledBlock> blocks, const AboveBytes& above,
                       std::vector<std::byte>& section);

// A piece as it was read, whole.
struct PieceBytes {
  PieceHead head;
  std::vector<std::byte> bytes;
  std::vector<FilledBlock> blocks() const;
  std::span<const std::byte> record() const;
};

// f of the head of each piece of a brick. DamagedArtifact where one fails its checks. Does nothing
// where the brick has none.
void each_piece_in(const ArtifactReader& file, std::uint64_t brick,
                   const std::function<void(const PieceHead&)>& f);
// DamagedArtifact where a part fails its checks.
PieceBytes read_piece_bytes(const ArtifactReader& file, const PieceHead& head);

// What BrickOctree has of a piece's parts. brick_level: log2 of the cells a side of its brick.
// DamagedArtifact where one fails its checks, or contradicts itself.
void read_piece_body(const ArtifactReader& file, const PieceRecord& piece, int brick_level,
                     BrickOctree& out);
void read_piece_ghosts(const ArtifactReader& file, const PieceRecord& piece, GhostLayer& out);
// All of it but its counts.
void read_octree(const ArtifactReader& file, const PieceHead& head, int brick_level,
                 BrickOctree& out);

}  // namespace voxweld
