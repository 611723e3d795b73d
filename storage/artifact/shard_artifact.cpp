#include "storage/artifact/shard_artifact.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "storage/artifact/node_record_bytes.h"

namespace voxweld {
namespace {

constexpr std::uint64_t page_of_directory = std::uint64_t{2} << 56;
constexpr std::uint64_t page_of_nodes = std::uint64_t{3} << 56;
constexpr std::uint64_t tables_section = std::uint64_t{4} << 56;
constexpr std::uint64_t first_pieces_section = tables_section | 1;
constexpr std::uint64_t first_nodes_section = tables_section | 2;

constexpr const char* wrong_clusters = "the clusters of a node contradict themselves";
constexpr std::uint64_t node_page_bytes = std::uint64_t{1} << 18;

struct ShardTables {
  std::uint64_t pieces = 0, nodes = 0;
};

struct NodeEntry {
  std::uint64_t material = 0, code = 0, level = 0;
  std::uint64_t polygons = 0, cubes = 0, leaves = 0, largest_piece = 0;
  std::uint64_t final_vertices = 0;
  std::uint64_t cluster_bytes = 0;  // of the record and the links
  Hash128 content;
  RootRecord record;

  std::uint64_t bytes() const {
    return sizeof(NodeEntry) + cubes * sizeof(CubeCount) + leaves * sizeof(TopLeaf) + cluster_bytes;
  }
};

static_assert(sizeof(NodeEntry) == 72 + 16 + sizeof(RootRecord));

template <class T>
void take(std::span<const std::byte>& bytes, std::size_t count, std::vector<T>& out) {
  out.resize(count);
  if (count > 0) std::memcpy(out.data(), bytes.data(), count * sizeof(T));
  bytes = bytes.subspan(count * sizeof(T));
}

void put(std::span<std::byte>& out, std::span<const std::byte> bytes) {
  if (!bytes.empty()) std::memcpy(out.data(), bytes.data(), bytes.size());
  out = out.subspan(bytes.size());
}

// What lies behind a node's leaves.
bool take_clusters(std::span<const std::byte> bytes, ReducedNode& clusters) {
  if (bytes.empty()) return true;
  RecordBytes in(bytes);
  return in.take(clusters.record) && in.take_links(clusters) && in.empty();
}

// False where its clusters contradict themselves. All else fits, since the sizes do.
bool take_node(std::span<const std::byte> bytes, MaterialNode& n) {
  NodeEntry record;
  std::memcpy(&record, bytes.data(), sizeof record);
  bytes = bytes.subspan(sizeof record);
  n.material = record.material;
  n.node.key = CellKey::of(record.code, record.level);
  n.node.record = record.record;
  n.node.polygons = record.polygons;
  n.largest_piece = record.largest_piece;
  n.final_vertices = record.final_vertices;
  n.content = record.content;
  take(bytes, record.cubes, n.node.cubes);
  take(bytes, record.leaves, n.node.leaves);
  return take_clusters(bytes, n.node.clusters);
}

}  // namespace

std::vector<std::byte> to_bytes(const MaterialNode& n) {
  NodeEntry record;
  record.material = n.material;
  record.code = n.node.key.code();
  record.level = static_cast<std::uint64_t>(n.node.key.level);
  record.polygons = n.node.polygons;
  record.cubes = n.node.cubes.size();
  record.leaves = n.node.leaves.size();
  record.largest_piece = n.largest_piece;
  record.final_vertices = n.final_vertices;
  record.content = n.content;
  record.record = n.node.record;
  std::vector<std::byte> clusters;
  if (n.node.clusters.record.has_surface()) {
    put_bytes(n.node.clusters.record, clusters);
    put_links(n.node.clusters, clusters);
  }
  record.cluster_bytes = clusters.size();
  std::vector<std::byte> bytes(record.bytes());
  std::span<std::byte> rest = bytes;
  put(rest, as_record(record));
  put(rest, as_section(n.node.cubes));
  put(rest, as_section(n.node.leaves));
  put(rest, clusters);
  return bytes;
}

MaterialNode material_node_of(std::span<const std::byte> bytes) {
  MaterialNode n;
  if (!take_node(bytes, n))
    throw std::logic_error("material_node_of: these are not the bytes of a node");
  return n;
}

ShardArtifactWriter::ShardArtifactWriter(const std::filesystem::path& path, Hash128 key,
                                         Hash128 input_stamp)
    : file_(path, {shard_kind, shard_version, key}), directory_(file_, page_of_directory) {
  file_.set_input_stamp(input_stamp);
}

void ShardArtifactWriter::begin_brick(std::uint64_t code) {
  brick_ = code;
  brick_bytes_ = 0;
  file_.begin_section(pieces_section(code));
}

void ShardArtifactWriter::end_brick() {
  file_.end_section();
}

void ShardArtifactWriter::append(std::span<const std::byte> bytes) {
  file_.append(bytes);
  brick_bytes_ += bytes.size();
}

PieceHead ShardArtifactWriter::piece(Material material, const BrickOctree& octree,
                                     std::span<const FilledBlock> blocks, const AboveBytes& above) {
  const PieceLists piece = piece_lists({material, brick_}, brick_bytes_, octree, blocks, above);
  append(head_bytes(piece.head));
  for (const auto& list : piece.lists) append(list);
  return piece.head;
}

void ShardArtifactWriter::brick(std::uint64_t code, std::span<const std::byte> pieces) {
  begin_brick(code);
  append(pieces);
  end_brick();
}

void ShardArtifactWriter::brick(std::uint64_t code, const ArtifactReader& from,
                                const std::function<void(const PieceBytes&)>& f) {
  if (from.find(pieces_section(code)) == nullptr) return;
  begin_brick(code);
  each_piece_in(from, code, [&](const PieceHead& head) {
    const PieceBytes piece = read_piece_bytes(from, head);
    append(head_bytes(head));
    append(piece.bytes);
    f(piece);
  });
  end_brick();
}

void ShardArtifactWriter::directory(const PieceRecord& record) {
  if (directory_.size() % page_records == 0) first_pieces_.push_back(record.key);
  directory_.push(record);
}

void ShardArtifactWriter::node(const MaterialNode& node) {
  if (nodes_.empty()) first_nodes_.push_back(node.material);
  const std::vector<std::byte> bytes = to_bytes(node);
  nodes_.insert(nodes_.end(), bytes.begin(), bytes.end());
  ++node_count_;
  if (nodes_.size() >= node_page_bytes) flush_nodes();
}

void ShardArtifactWriter::flush_nodes() {
  file_.section(page_of_nodes + first_nodes_.size() - 1, nodes_);
  nodes_.clear();
}

Hash128 ShardArtifactWriter::finish(const ShardSummary& summary, const ShardHistory& history) {
  const ShardTables tables{directory_.size(), node_count_};
  directory_.finish();
  if (!nodes_.empty()) flush_nodes();
  file_.section(tables_section, as_record(tables));
  file_.section(first_pieces_section, as_section(first_pieces_));
  file_.section(first_nodes_section, as_section(first_nodes_));
  write_summary(file_, summary);
  write_history(file_, history);
  return file_.commit();
}

ShardArtifact::ShardArtifact(const std::filesystem::path& path)
    : OpenArtifact(path, shard_kind, shard_version) {
  const auto tables = file_.read_record<ShardTables>(tables_section, "has no tables");
  file_.read_array(first_pieces_section, first_pieces_);
  file_.read_array(first_nodes_section, first_nodes_);
  pieces_ = tables.pieces;
  nodes_ = tables.nodes;
  if (first_pieces_.size() != (pieces_ + page_records - 1) / page_records)
    file_.damaged("its directory contradicts itself");
}

std::vector<PieceRecord> ShardArtifact::pieces(Material material) const {
  // The page before the first that begins with the label, or behind it, may end with it.
  auto page = std::lower_bound(first_pieces_.begin(), first_pieces_.end(), PieceKey{material, 0});
  if (page != first_pieces_.begin()) --page;
  const PagedTable<PieceRecord> directory(file_, page_of_directory, pieces_);
  std::vector<PieceRecord> found;
  for (; page != first_pieces_.end() && page->material <= material; ++page) {
    const auto first = static_cast<std::uint64_t>(page - first_pieces_.begin()) * page_records;
    for (const PieceRecord& record : directory.read(first, std::min(page_records, pieces_ - first)))
      if (record.key.material == material) found.push_back(record);
  }
  return found;
}

void ShardArtifact::each_piece(const std::function<void(const PieceRecord&)>& f) const {
  const PagedTable<PieceRecord> directory(file_, page_of_directory, pieces_);
  for (std::uint64_t first = 0; first < pieces_; first += page_records)
    for (const PieceRecord& record : directory.read(first, std::min(page_records, pieces_ - first)))
      f(record);
}

void ShardArtifact::read_piece(const PieceRecord& piece, int brick_level, BrickOctree& out) const {
  read_piece_body(file_, piece, brick_level, out);
  read_ghost_layer(piece, out.ghost);
}

void ShardArtifact::read_ghost_layer(const PieceRecord& piece, GhostLayer& out) const {
  read_piece_ghosts(file_, piece, out);
}

namespace {

// f(record, bytes) of each node of a page.
template <class F>
void each_record(const ArtifactReader& file, std::uint64_t page, const F& f) {
  std::vector<std::byte> bytes;
  file.read(page_of_nodes + page, bytes);
  for (std::span<const std::byte> rest = bytes; !rest.empty();) {
    NodeEntry record;
    if (rest.size() < sizeof record) file.damaged("a page of nodes ends within one");
    std::memcpy(&record, rest.data(), sizeof record);
    if (record.level > max_levels || record.cubes > rest.size() || record.leaves > rest.size() ||
        record.cluster_bytes > rest.size() || record.bytes() > rest.size())
      file.damaged("a page of nodes contradicts itself");
    const std::span<const std::byte> own = rest.first(record.bytes());
    f(record, own);
    rest = rest.subspan(record.bytes());
  }
}

}  // namespace

void ShardArtifact::each_node(
    std::uint64_t page,
    const std::function<void(const MaterialNode&, std::span<const std::byte>)>& f) const {
  each_record(file_, page, [&](const NodeEntry&, std::span<const std::byte> bytes) {
    MaterialNode node;
    if (!take_node(bytes, node)) file_.damaged(wrong_clusters);
    f(node, bytes);
  });
}

std::optional<ReducedNode> ShardArtifact::clusters(Material material, const CellKey& node) const {
  std::optional<ReducedNode> found;
  // The page before the first that begins with the label, or behind it, may end with it.
  auto page = std::lower_bound(first_nodes_.begin(), first_nodes_.end(), material);
  if (page != first_nodes_.begin()) --page;
  for (; page != first_nodes_.end() && *page <= material && !found; ++page)
    each_record(file_, static_cast<std::uint64_t>(page - first_nodes_.begin()),
                [&](const NodeEntry& record, std::span<const std::byte> bytes) {
                  if (record.material != material || record.code != node.code() ||
                      record.level != static_cast<std::uint64_t>(node.level) ||
                      record.cluster_bytes == 0)
                    return;
                  if (!take_clusters(bytes.last(record.cluster_bytes), found.emplace()))
                    file_.damaged(wrong_clusters);
                });
  return found;
}

}  // namespace voxweld
