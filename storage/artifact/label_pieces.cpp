#include "storage/artifact/label_pieces.h"

#include <algorithm>
#include <cstring>

#include "storage/artifact/brick_levels_bytes.h"
#include "storage/artifact/node_record_bytes.h"

namespace voxweld {
namespace {

// As it lies in the file.
struct PieceHeadRecord {
  PieceHead head;
  Hash128 check;  // of the head
};
static_assert(sizeof(PieceRecord) == 24 + 40 + 48 &&
              sizeof(PieceHeadRecord) == sizeof(PieceRecord) + sizeof(RootRecord) + 16);

Hash128 check_of(const PieceHead& head) {
  return hash_bytes(as_record(head));
}

template <class T>
void take_values(std::span<const std::byte>& bytes, std::size_t count, std::vector<T>& out) {
  out.resize(count);
  if (count > 0) std::memcpy(static_cast<void*>(out.data()), bytes.data(), count * sizeof(T));
  bytes = bytes.subspan(count * sizeof(T));
}

template <class... Parts>
std::vector<std::byte> joined(const Parts&... parts) {
  std::vector<std::byte> bytes;
  bytes.reserve((parts.size() + ...));
  (bytes.insert(bytes.end(), parts.begin(), parts.end()), ...);
  return bytes;
}

LevelsSize levels_size(const PieceRecord& piece) {
  return {piece.vertices, piece.kept_clusters, piece.block_merges};
}

// A part of a piece, checked.
std::vector<std::byte> read_part(const ArtifactReader& file, const PieceRecord& piece,
                                 std::uint64_t offset, std::uint64_t size, const Hash128& hash) {
  std::vector<std::byte> bytes(size);
  file.read_part(pieces_section(piece.key.brick), offset, bytes);
  if (hash_bytes(bytes) != hash)
    file.damaged("the checksum of a piece of label " + std::to_string(piece.key.material) +
                 " is wrong");
  return bytes;
}

std::vector<std::byte> read_body(const ArtifactReader& file, const PieceRecord& piece) {
  return read_part(file, piece, piece.offset, piece.body_bytes(), piece.body);
}
std::vector<std::byte> read_ghost_bytes(const ArtifactReader& file, const PieceRecord& piece) {
  return read_part(file, piece, piece.offset + piece.body_bytes(), piece.ghost_bytes(),
                   piece.ghost);
}
std::vector<std::byte> read_levels(const ArtifactReader& file, const PieceRecord& piece) {
  return read_part(file, piece, piece.offset + piece.body_bytes() + piece.ghost_bytes(),
                   piece.levels_bytes(), piece.levels);
}

// What is left of a body behind its blocks and roots: the record.
std::span<const std::byte> take_body(const ArtifactReader& file, const PieceRecord& piece,
                                     std::span<const std::byte> rest, int brick_level,
                                     BrickOctree& out) {
  take_values(rest, piece.vertices, out.vertices);
  take_values(rest, piece.polygons, out.polygons);
  out.emit_levels.clear();
  out.pairs.clear();
  out.polygon_pairs.clear();
  std::vector<FilledBlock> blocks;
  take_values(rest, piece.blocks, blocks);
  take_values(rest, piece.by_sheets() ? piece.vertices : 0, out.roots);
  out.blocks.assign(std::size_t{1} << (3 * (brick_level - block_level)), BlockCount{});
  auto block = blocks.begin();
  std::uint32_t end = 0;
  for (std::uint32_t b = 0; b < out.blocks.size(); ++b) {
    if (block != blocks.end() && block->block == b) {
      end += block->polygons;
      out.blocks[b].vertices = block->vertices;
      ++block;
    }
    out.blocks[b].polygon_end = end;
  }
  if (block != blocks.end() || end != piece.polygons)
    file.damaged("the parts of a piece contradict each other");
  return rest;
}

void take_ghosts(const PieceRecord& piece, std::span<const std::byte> rest, GhostLayer& out) {
  take_values(rest, piece.ghost_cells, out.cells);
  take_values(rest, piece.ghost_vertices, out.vertices);
  take_values(rest, piece.apart, out.apart);
  take_values(rest, piece.by_sheets() ? piece.ghost_vertices : 0, out.roots);
  out.sheets_of_edges.clear();
}

}  // namespace

std::uint64_t PieceRecord::body_bytes() const {
  return std::uint64_t{vertices} * sizeof(LeafVertex) +
         std::uint64_t{polygons} * sizeof(PolygonRefs) +
         std::uint64_t{blocks} * sizeof(FilledBlock) +
         (by_sheets() ? std::uint64_t{vertices} + record_bytes : 0);
}

std::uint64_t PieceRecord::ghost_bytes() const {
  return std::uint64_t{ghost_cells} * sizeof(GhostCell) +
         std::uint64_t{ghost_vertices} * sizeof(GhostVertex) +
         std::uint64_t{apart} * sizeof(std::uint32_t) + (by_sheets() ? ghost_vertices : 0);
}

std::uint64_t PieceRecord::levels_bytes() const {
  return by_sheets() ? levels_size(*this).bytes() : 0;
}

std::vector<FilledBlock> PieceBytes::blocks() const {
  std::vector<FilledBlock> blocks;
  std::span<const std::byte> rest =
      std::span(body).subspan(std::uint64_t{head.piece.vertices} * sizeof(LeafVertex) +
                              std::uint64_t{head.piece.polygons} * sizeof(PolygonRefs));
  take_values(rest, head.piece.blocks, blocks);
  return blocks;
}

std::vector<std::byte> PieceBytes::head_bytes() const {
  const PieceHeadRecord record{head, check_of(head)};
  const auto bytes = as_record(record);
  return {bytes.begin(), bytes.end()};
}

PieceBytes piece_bytes(const PieceKey& key, std::uint64_t offset, const BrickOctree& octree,
                       std::span<const FilledBlock> blocks, std::span<const std::byte> record) {
  const auto size = [](const auto& values) { return static_cast<std::uint32_t>(values.size()); };
  const GhostLayer& ghost = octree.ghost;
  PieceBytes piece;
  piece.body = joined(as_section(octree.vertices), as_section(octree.polygons),
                      std::as_bytes(blocks), as_section(octree.roots), record);
  piece.ghost = joined(as_section(ghost.cells), as_section(ghost.vertices), as_section(ghost.apart),
                       as_section(ghost.roots));
  if (!record.empty()) put_levels(octree.levels, piece.levels);
  piece.head.root = octree.root;
  PieceRecord& head = piece.head.piece;
  head.key = key;
  head.offset = offset + sizeof(PieceHeadRecord);
  head.vertices = size(octree.vertices);
  head.polygons = size(octree.polygons);
  head.blocks = size(blocks);
  head.ghost_cells = size(ghost.cells);
  head.ghost_vertices = size(ghost.vertices);
  head.apart = size(ghost.apart);
  head.record_bytes = size(record);
  head.final_vertices =
      static_cast<std::uint32_t>(std::ranges::count(octree.roots, BrickOctree::no_root));
  head.kept_clusters = size(octree.levels.clusters);
  head.block_merges = size(octree.levels.merges);
  head.body = hash_bytes(piece.body);
  head.ghost = hash_bytes(piece.ghost);
  head.levels = hash_bytes(piece.levels);
  return piece;
}

void each_piece_in(const ArtifactReader& file, std::uint64_t brick,
                   const std::function<void(const PieceBytes&)>& f) {
  const std::uint64_t name = pieces_section(brick);
  const SectionRecord* section = file.find(name);
  if (section == nullptr) return;
  PieceBytes bytes;
  for (std::uint64_t at = 0; at < section->size;) {
    PieceHeadRecord record;
    if (section->size - at < sizeof record) file.damaged("a brick ends within a piece");
    file.read_part(name, at, std::as_writable_bytes(std::span(&record, 1)));
    const PieceRecord& piece = record.head.piece;
    const std::uint64_t size = piece.body_bytes() + piece.ghost_bytes() + piece.levels_bytes();
    if (record.check != check_of(record.head) || piece.key.brick != brick ||
        piece.offset != at + sizeof record || size > section->size - piece.offset)
      file.damaged("the head of a piece is wrong");
    bytes.head = record.head;
    bytes.body = read_body(file, piece);
    bytes.ghost = read_ghost_bytes(file, piece);
    bytes.levels = read_levels(file, piece);
    at = piece.offset + size;
    f(bytes);
  }
}

void take_octree(const ArtifactReader& file, const PieceBytes& bytes, int brick_level,
                 BrickOctree& out) {
  const PieceRecord& piece = bytes.head.piece;
  const auto record = take_body(file, piece, bytes.body, brick_level, out);
  take_ghosts(piece, bytes.ghost, out.ghost);
  out.root = bytes.head.root;
  out.record = {};
  out.levels.clear();
  if (!piece.by_sheets()) return;
  RecordBytes in(record);
  if (!in.take(out.record) || !in.empty()) file.damaged("the record of a piece contradicts itself");
  out.levels = levels_of(bytes.levels, levels_size(piece));
}

void read_piece_body(const ArtifactReader& file, const PieceRecord& piece, int brick_level,
                     BrickOctree& out) {
  take_body(file, piece, read_body(file, piece), brick_level, out);
}

void read_piece_ghosts(const ArtifactReader& file, const PieceRecord& piece, GhostLayer& out) {
  take_ghosts(piece, read_ghost_bytes(file, piece), out);
}

}  // namespace voxweld
