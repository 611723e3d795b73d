#include "storage/artifact/brick_pieces.h"

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
// Records are written as they lie in memory, so none may have padding, which would carry whatever
// was there before.
static_assert(std::has_unique_object_representations_v<GhostCell> &&
              std::has_unique_object_representations_v<FilledBlock> &&
              std::has_unique_object_representations_v<PolygonRefs> &&
              std::has_unique_object_representations_v<MaterialPair>);
static_assert(sizeof(LeafVertex) == 28 && sizeof(GhostVertex) == 32 &&
              sizeof(RootRecord) == 8 + 60 + 40 + 28 + 8 + 64 &&
              sizeof(PieceRecord) == 24 + 48 + 48 &&
              sizeof(PieceHeadRecord) == sizeof(PieceRecord) + sizeof(RootRecord) + 16);

constexpr std::uint32_t has_emit_levels = 1, has_ghost_sheets = 2;

Hash128 check_of(const PieceHead& head) {
  return hash_bytes(as_record(head));
}

LevelsSize levels_size(const PieceRecord& piece) {
  return {piece.vertices, piece.kept_clusters, piece.block_merges};
}

Hash128 hash_of(std::span<const std::span<const std::byte>> lists) {
  StreamHasher hash;
  for (const auto& list : lists) hash.update(list);
  return hash.finish();
}

[[noreturn]] void wrong_checksum(const ArtifactReader& file, const PieceKey& key) {
  file.damaged("the checksum of a piece in brick " + std::to_string(key.brick) + " is wrong");
}

// The lists of one part of a piece, read one after the other into where they belong.
class PartReader {
 public:
  // begin: of the part, counted from where the body begins.
  PartReader(const ArtifactReader& file, const PieceRecord& piece, std::uint64_t begin)
      : file_(file), key_(piece.key), offset_(piece.offset + begin) {
    // Before memory is taken for it.
    const SectionRecord* section = file.find(pieces_section(key_.brick));
    if (section == nullptr || piece.offset > section->size ||
        piece.bytes() > section->size - piece.offset)
      file.damaged("a piece is longer than its brick");
  }

  template <class T>
  void take(std::uint64_t count, std::vector<T>& out) {
    out.resize(count);
    if (count == 0) return;
    const auto bytes = std::as_writable_bytes(std::span(out));
    file_.read_part(pieces_section(key_.brick), offset_, bytes);
    hash_.update(bytes);
    offset_ += bytes.size();
  }
  // After the last.
  void check(const Hash128& hash) {
    if (hash_.finish() != hash) wrong_checksum(file_, key_);
  }

 private:
  const ArtifactReader& file_;
  PieceKey key_;
  std::uint64_t offset_;
  StreamHasher hash_;
};

// False where they do not fit the brick or its polygons.
bool take_blocks(std::span<const FilledBlock> filled, std::uint32_t polygons, int brick_level,
                 std::vector<BlockCount>& out) {
  out.assign(std::size_t{1} << (3 * (brick_level - block_level)), BlockCount{});
  auto block = filled.begin();
  std::uint32_t end = 0;
  for (std::uint32_t b = 0; b < out.size(); ++b) {
    if (block != filled.end() && block->block == b) {
      end += block->polygons;
      out[b].vertices = block->vertices;
      ++block;
    }
    out[b].polygon_end = end;
  }
  return block == filled.end() && end == polygons;
}

void read_above(const ArtifactReader& file, const PieceRecord& piece, BrickOctree& out) {
  out.record = {};
  out.levels.clear();
  if (!piece.by_sheets()) return;
  PartReader in(file, piece, piece.stitched_bytes());
  std::vector<std::byte> bytes;
  in.take(piece.above_bytes(), bytes);
  in.check(piece.above);
  RecordBytes record{std::span(bytes).first(piece.record_bytes)};
  if (!record.take(out.record) || !record.empty())
    file.damaged("the record of a piece contradicts itself");
  out.levels = levels_of(std::span(bytes).subspan(piece.record_bytes), levels_size(piece));
}

}  // namespace

std::uint64_t PieceRecord::body_bytes() const {
  const std::uint64_t a_polygon = sizeof(PolygonRefs) + ((lists & has_emit_levels) != 0 ? 1 : 0) +
                                  (pairs != 0 ? sizeof(std::uint32_t) : 0);
  return vertices * (sizeof(LeafVertex) + (by_sheets() ? 1 : 0)) + polygons * a_polygon +
         blocks * sizeof(FilledBlock) + pairs * sizeof(MaterialPair);
}

std::uint64_t PieceRecord::ghost_bytes() const {
  const std::uint64_t a_cell =
      sizeof(GhostCell) + ((lists & has_ghost_sheets) != 0 ? sizeof(std::uint32_t) : 0);
  return ghost_cells * a_cell + ghost_vertices * (sizeof(GhostVertex) + (by_sheets() ? 1 : 0)) +
         apart * sizeof(std::uint32_t);
}

std::uint64_t PieceRecord::above_bytes() const {
  return by_sheets() ? record_bytes + levels_size(*this).bytes() : 0;
}

std::vector<FilledBlock> PieceBytes::blocks() const {
  const PieceRecord& piece = head.piece;
  std::vector<FilledBlock> blocks(piece.blocks);
  if (!blocks.empty())
    std::memcpy(
        blocks.data(),
        bytes.data() + piece.vertices * sizeof(LeafVertex) + piece.polygons * sizeof(PolygonRefs),
        blocks.size() * sizeof(FilledBlock));
  return blocks;
}

std::span<const std::byte> PieceBytes::record() const {
  return std::span(bytes).subspan(head.piece.stitched_bytes(), head.piece.record_bytes);
}

std::vector<std::byte> head_bytes(const PieceHead& head) {
  const PieceHeadRecord record{head, check_of(head)};
  const auto bytes = as_record(record);
  return {bytes.begin(), bytes.end()};
}

void put_above(const BrickOctree& octree, AboveBytes& out) {
  out.bytes.clear();
  if (!octree.roots.empty()) put_bytes(octree.record, out.bytes);
  out.record_bytes = out.bytes.size();
  if (!octree.roots.empty()) put_levels(octree.levels, out.bytes);
}

PieceLists piece_lists(const PieceKey& key, std::uint64_t offset, const BrickOctree& octree,
                       std::span<const FilledBlock> blocks, const AboveBytes& above) {
  const auto size = [](const auto& values) { return static_cast<std::uint32_t>(values.size()); };
  const GhostLayer& ghost = octree.ghost;
  PieceLists piece;
  piece.lists = {as_section(octree.vertices),
                 as_section(octree.polygons),
                 std::as_bytes(blocks),
                 as_section(octree.emit_levels),
                 as_section(octree.pairs),
                 as_section(octree.polygon_pairs),
                 as_section(octree.roots),
                 as_section(ghost.cells),
                 as_section(ghost.vertices),
                 as_section(ghost.sheets_of_edges),
                 as_section(ghost.apart),
                 as_section(ghost.roots),
                 above.bytes};
  constexpr std::size_t of_body = 7, of_ghost = 5;
  const std::span lists(piece.lists);
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
  head.record_bytes = static_cast<std::uint32_t>(above.record_bytes);
  head.final_vertices =
      static_cast<std::uint32_t>(std::ranges::count(octree.roots, BrickOctree::no_root));
  head.kept_clusters = size(octree.levels.clusters);
  head.block_merges = size(octree.levels.merges);
  head.pairs = size(octree.pairs);
  head.lists = (octree.emit_levels.empty() ? 0 : has_emit_levels) |
               (ghost.sheets_of_edges.empty() ? 0 : has_ghost_sheets);
  head.body = hash_of(lists.first(of_body));
  head.ghost = hash_of(lists.subspan(of_body, of_ghost));
  head.above = hash_of(lists.last(1));
  return piece;
}

PieceHead append_piece(const PieceKey& key, const BrickOctree& octree,
                       std::span<const FilledBlock> blocks, const AboveBytes& above,
                       std::vector<std::byte>& section) {
  const PieceLists piece = piece_lists(key, section.size(), octree, blocks, above);
  const std::vector<std::byte> head = head_bytes(piece.head);
  std::size_t size = section.size() + head.size();
  for (const auto& list : piece.lists) size += list.size();
  if (size > section.capacity()) section.reserve(section.empty() ? size : 2 * size);
  section.insert(section.end(), head.begin(), head.end());
  for (const auto& list : piece.lists) section.insert(section.end(), list.begin(), list.end());
  return piece.head;
}

void each_piece_in(const ArtifactReader& file, std::uint64_t brick,
                   const std::function<void(const PieceHead&)>& f) {
  const std::uint64_t name = pieces_section(brick);
  const SectionRecord* section = file.find(name);
  if (section == nullptr) return;
  for (std::uint64_t at = 0; at < section->size;) {
    PieceHeadRecord record;
    if (section->size - at < sizeof record) file.damaged("a brick ends within a piece");
    file.read_part(name, at, std::as_writable_bytes(std::span(&record, 1)));
    const PieceRecord& piece = record.head.piece;
    if (record.check != check_of(record.head) || piece.key.brick != brick ||
        piece.offset != at + sizeof record || piece.bytes() > section->size - piece.offset)
      file.damaged("the head of a piece is wrong");
    at = piece.offset + piece.bytes();
    f(record.head);
  }
}

PieceBytes read_piece_bytes(const ArtifactReader& file, const PieceHead& head) {
  const PieceRecord& piece = head.piece;
  PieceBytes read{head, std::vector<std::byte>(piece.bytes())};
  file.read_part(pieces_section(piece.key.brick), piece.offset, read.bytes);
  const std::span<const std::byte> all(read.bytes);
  if (hash_bytes(all.first(piece.body_bytes())) != piece.body ||
      hash_bytes(all.subspan(piece.body_bytes(), piece.ghost_bytes())) != piece.ghost ||
      hash_bytes(all.last(piece.above_bytes())) != piece.above)
    wrong_checksum(file, piece.key);
  return read;
}

void read_piece_body(const ArtifactReader& file, const PieceRecord& piece, int brick_level,
                     BrickOctree& out) {
  PartReader in(file, piece, 0);
  std::vector<FilledBlock> blocks;
  in.take(piece.vertices, out.vertices);
  in.take(piece.polygons, out.polygons);
  in.take(piece.blocks, blocks);
  in.take((piece.lists & has_emit_levels) != 0 ? piece.polygons : 0, out.emit_levels);
  in.take(piece.pairs, out.pairs);
  in.take(piece.pairs != 0 ? piece.polygons : 0, out.polygon_pairs);
  in.take(piece.by_sheets() ? piece.vertices : 0, out.roots);
  in.check(piece.body);
  const auto names_a_pair = [&](std::uint32_t place) { return place < out.pairs.size(); };
  if (!take_blocks(blocks, piece.polygons, brick_level, out.blocks) ||
      !std::ranges::all_of(out.polygon_pairs, names_a_pair))
    file.damaged("the parts of a piece contradict each other");
}

void read_piece_ghosts(const ArtifactReader& file, const PieceRecord& piece, GhostLayer& out) {
  PartReader in(file, piece, piece.body_bytes());
  in.take(piece.ghost_cells, out.cells);
  in.take(piece.ghost_vertices, out.vertices);
  in.take((piece.lists & has_ghost_sheets) != 0 ? piece.ghost_cells : 0, out.sheets_of_edges);
  in.take(piece.apart, out.apart);
  in.take(piece.by_sheets() ? piece.ghost_vertices : 0, out.roots);
  in.check(piece.ghost);
}

void read_octree(const ArtifactReader& file, const PieceHead& head, int brick_level,
                 BrickOctree& out) {
  read_piece_body(file, head.piece, brick_level, out);
  read_piece_ghosts(file, head.piece, out.ghost);
  read_above(file, head.piece, out);
  out.root = head.root;
}

}  // namespace voxweld
