// Pieces: of a label volume (labels.mode = "each") the octree of one label in one brick, as it lies in
// the brick's section of an octree artifact (label_shard_artifact.h): head, body, ghost layer, levels.
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
  std::uint64_t offset = 0;  // of the body in the brick's section; the ghost layer comes behind it
  std::uint32_t vertices = 0, polygons = 0, blocks = 0, ghost_cells = 0, ghost_vertices = 0;
  // Where each sheet collapses by itself, else 0: GhostLayer::apart, the bytes of the NodeRecord,
  // and the vertices that nothing above the brick can take in.
  std::uint32_t apart = 0, record_bytes = 0, final_vertices = 0;
  // And of its levels: BrickLevels::clusters and merges.
  std::uint32_t kept_clusters = 0, block_merges = 0;
  Hash128 body, ghost, levels;

  bool by_sheets() const { return record_bytes != 0; }
  std::uint64_t body_bytes() const;
  std::uint64_t ghost_bytes() const;
  std::uint64_t levels_bytes() const;
};

// A label that fills a brick has nothing but a head there; the directory leaves it out.
struct PieceHead {
  PieceRecord piece;
  RootRecord root;
};

// The section of a brick's pieces, by the Morton code of its index.
constexpr std::uint64_t pieces_section(std::uint64_t brick) {
  return brick << 8 | 1;
}

// A piece in bytes, each part with its checksum in the head.
struct PieceBytes {
  PieceHead head;
  std::vector<std::byte> body, ghost, levels;
  std::uint64_t bytes() const { return body.size() + ghost.size() + levels.size(); }
  std::vector<FilledBlock> blocks() const;
  std::span<const std::byte> record() const {
    return std::span(body).last(head.piece.record_bytes);
  }
  // The head, as it lies in the file.
  std::vector<std::byte> head_bytes() const;
};

// key, offset: where the piece is to lie; the offset is that of its head. blocks:
// filled_blocks(octree.blocks). record: of put_bytes(octree.record), or empty where sheets do not
// collapse by themselves.
PieceBytes piece_bytes(const PieceKey& key, std::uint64_t offset, const BrickOctree& octree,
                       std::span<const FilledBlock> blocks, std::span<const std::byte> record);

// f of each piece of a brick, whole. DamagedArtifact where one fails its checks. Does nothing where
// the brick has none.
void each_piece_in(const ArtifactReader& file, std::uint64_t brick,
                   const std::function<void(const PieceBytes&)>& f);

// All of a piece but its counts. brick_level: log2 of the cells a side of its brick. DamagedArtifact
// where its parts contradict each other.
void take_octree(const ArtifactReader& file, const PieceBytes& piece, int brick_level,
                 BrickOctree& out);

// Parts of a piece, alone: what BrickOctree has but ghost layer, root, record, levels and counts, and
// the ghost layer.
void read_piece_body(const ArtifactReader& file, const PieceRecord& piece, int brick_level,
                     BrickOctree& out);
void read_piece_ghosts(const ArtifactReader& file, const PieceRecord& piece, GhostLayer& out);

}  // namespace voxweld
