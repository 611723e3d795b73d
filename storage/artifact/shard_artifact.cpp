#include "storage/artifact/shard_artifact.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "storage/artifact/brick_levels_bytes.h"
#include "storage/artifact/node_record_bytes.h"

namespace voxweld {
namespace {

enum Part : std::uint64_t {
  vertices = 1,
  polygons,
  emit_levels,
  blocks,
  ghost_cells,
  ghost_vertices,
  pairs,
  polygon_pairs,
  sheets_of_edges,
  roots,
  ghost_apart,
  ghost_roots,
  node_record,
  levels,
  end_of_stitched = node_record  // stitch reads those before
};
// Of the shard as a whole, beside those of shard_summary.h.
constexpr std::uint64_t nodes_section = shard_section(2);
constexpr std::uint64_t cubes_section = shard_section(3);
constexpr std::uint64_t leaves_section = shard_section(4);
constexpr std::uint64_t records_section = shard_section(7);
constexpr std::uint64_t links_section = shard_section(16);  // of the first node

constexpr std::uint64_t section_name(std::uint64_t code, std::uint64_t part) {
  return code << 8 | part;
}

struct ShardNodeRecord {
  std::uint64_t code;
  std::uint64_t level;
  std::uint64_t polygons, cubes, leaves;
  RootRecord record;
};

// Records are written as they lie in memory, so none may have padding, which would carry whatever
// was there before.
static_assert(std::has_unique_object_representations_v<GhostCell> &&
              std::has_unique_object_representations_v<BlockCount> &&
              std::has_unique_object_representations_v<PolygonRefs> &&
              std::has_unique_object_representations_v<CubeCount>);
static_assert(sizeof(LeafVertex) == 28 && sizeof(GhostVertex) == 32 && sizeof(TopLeaf) == 48 &&
              sizeof(RootRecord) == 8 + 52 + 40 + 28 + 8 + 64 &&
              std::has_unique_object_representations_v<MaterialPair> &&
              sizeof(ShardNodeRecord) == 40 + sizeof(RootRecord));

}  // namespace

ShardArtifactWriter::ShardArtifactWriter(const std::filesystem::path& path, Hash128 key,
                                         Hash128 input_stamp)
    : file_(path, {shard_kind, shard_version, key}) {
  file_.set_input_stamp(input_stamp);
}

void ShardArtifactWriter::brick(std::uint64_t code, const BrickOctree& octree) {
  file_.section(section_name(code, vertices), as_section(octree.vertices));
  file_.section(section_name(code, polygons), as_section(octree.polygons));
  const auto where_any = [&](Part part, const auto& values) {
    if (!values.empty()) file_.section(section_name(code, part), as_section(values));
  };
  where_any(emit_levels, octree.emit_levels);
  where_any(pairs, octree.pairs);
  where_any(polygon_pairs, octree.polygon_pairs);
  where_any(sheets_of_edges, octree.ghost.sheets_of_edges);
  file_.section(section_name(code, blocks), as_section(octree.blocks));
  file_.section(section_name(code, ghost_cells), as_section(octree.ghost.cells));
  file_.section(section_name(code, ghost_vertices), as_section(octree.ghost.vertices));
  where_any(roots, octree.roots);
  where_any(ghost_apart, octree.ghost.apart);
  where_any(ghost_roots, octree.ghost.roots);
  if (octree.roots.empty()) return;
  section_.clear();
  put_bytes(octree.record, section_);
  file_.section(section_name(code, node_record), section_);
  const std::array<std::uint32_t, 2> sizes = {
      static_cast<std::uint32_t>(octree.levels.clusters.size()),
      static_cast<std::uint32_t>(octree.levels.merges.size())};
  section_.assign(as_record(sizes).begin(), as_record(sizes).end());
  put_levels(octree.levels, section_);
  file_.section(section_name(code, levels), section_);
}

void ShardArtifactWriter::brick(std::uint64_t code, const ArtifactReader& from) {
  // In the order of the other one, so that the same bricks are the same file.
  for (const Part part :
       {vertices, polygons, emit_levels, pairs, polygon_pairs, sheets_of_edges, blocks, ghost_cells,
        ghost_vertices, roots, ghost_apart, ghost_roots, node_record, levels}) {
    const std::uint64_t name = section_name(code, part);
    if (from.find(name) == nullptr) continue;
    from.read(name, section_);
    file_.section(name, section_);
  }
}

Hash128 ShardArtifactWriter::finish(const ShardSummary& summary, std::span<const ShardNode> nodes,
                                    const ShardHistory& history) {
  std::vector<ShardNodeRecord> node_records;
  std::vector<CubeCount> cubes;
  std::vector<TopLeaf> leaves;
  for (const ShardNode& node : nodes) {
    node_records.push_back({node.key.code(), static_cast<std::uint64_t>(node.key.level),
                            node.polygons, node.cubes.size(), node.leaves.size(), node.record});
    cubes.insert(cubes.end(), node.cubes.begin(), node.cubes.end());
    leaves.insert(leaves.end(), node.leaves.begin(), node.leaves.end());
  }
  write_summary(file_, summary);
  file_.section(nodes_section, as_section(node_records));
  file_.section(cubes_section, as_section(cubes));
  file_.section(leaves_section, as_section(leaves));
  write_clusters(nodes);
  write_history(file_, history);
  return file_.commit();
}

void ShardArtifactWriter::write_clusters(std::span<const ShardNode> nodes) {
  const auto has_surface = [](const ShardNode& node) { return node.clusters.record.has_surface(); };
  if (std::ranges::none_of(nodes, has_surface)) return;
  section_.clear();
  for (const ShardNode& node : nodes) put_bytes(node.clusters.record, section_);
  file_.section(records_section, section_);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (!has_surface(nodes[i])) continue;
    section_.clear();
    put_links(nodes[i].clusters, section_);
    file_.section(links_section + i, section_);
  }
}

ShardArtifact::ShardArtifact(const std::filesystem::path& path)
    : OpenArtifact(path, shard_kind, shard_version) {}

std::vector<ShardNode> ShardArtifact::nodes() const {
  const auto records = file_.read_array<ShardNodeRecord>(nodes_section);
  const auto cubes = file_.read_array<CubeCount>(cubes_section);
  const auto leaves = file_.read_array<TopLeaf>(leaves_section);
  const std::vector<NodeRecord> clusters = node_records(records.size());
  std::vector<ShardNode> nodes;
  auto cube = cubes.begin();
  auto leaf = leaves.begin();
  for (const ShardNodeRecord& r : records) {
    if (r.level > max_levels || r.cubes > static_cast<std::uint64_t>(cubes.end() - cube) ||
        r.leaves > static_cast<std::uint64_t>(leaves.end() - leaf))
      file_.damaged("its summary contradicts itself");
    ShardNode node;
    node.key = CellKey::of(r.code, r.level);
    node.record = r.record;
    node.polygons = r.polygons;
    node.cubes.assign(cube, cube + static_cast<std::ptrdiff_t>(r.cubes));
    node.leaves.assign(leaf, leaf + static_cast<std::ptrdiff_t>(r.leaves));
    cube += static_cast<std::ptrdiff_t>(r.cubes);
    leaf += static_cast<std::ptrdiff_t>(r.leaves);
    if (!clusters.empty()) node.clusters.record = clusters[nodes.size()];
    nodes.push_back(std::move(node));
  }
  return nodes;
}

// Of each node, or none.
std::vector<NodeRecord> ShardArtifact::node_records(std::size_t count) const {
  if (file_.find(records_section) == nullptr) return {};
  std::vector<std::byte> bytes;
  file_.read(records_section, bytes);
  RecordBytes in(bytes);
  std::vector<NodeRecord> records(count);
  for (NodeRecord& record : records)
    if (!in.take(record)) file_.damaged("the records of its nodes contradict themselves");
  return records;
}

std::optional<ReducedNode> ShardArtifact::clusters(const CellKey& node) const {
  const auto all = file_.read_array<ShardNodeRecord>(nodes_section);
  std::vector<NodeRecord> records = node_records(all.size());
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (all[i].code != node.code() || all[i].level != static_cast<std::uint64_t>(node.level))
      continue;
    if (!records[i].has_surface()) return std::nullopt;
    ReducedNode found{std::move(records[i]), {}, {}, {}, {}};
    std::vector<std::byte> bytes;
    file_.read(links_section + i, bytes);
    if (!RecordBytes(bytes).take_links(found))
      file_.damaged("the links of its clusters contradict themselves");
    return found;
  }
  return std::nullopt;
}

NodeRecord read_node_record(const ArtifactReader& file, std::uint64_t code) {
  NodeRecord record;
  const std::uint64_t name = section_name(code, node_record);
  if (file.find(name) == nullptr) return record;
  std::vector<std::byte> bytes;
  file.read(name, bytes);
  if (!RecordBytes(bytes).take(record)) file.damaged("the record of a brick contradicts itself");
  return record;
}

std::vector<BlockCount> read_block_counts(const ArtifactReader& file, std::uint64_t code) {
  return file.read_array<BlockCount>(section_name(code, blocks));
}

bool ShardArtifact::has_brick(std::uint64_t code) const {
  return file_.find(section_name(code, vertices)) != nullptr;
}

void ShardArtifact::add_brick_hashes(std::uint64_t code, KeyHasher& key) const {
  for (std::uint64_t part = vertices; part < end_of_stitched; ++part)
    if (const SectionRecord* record = file_.find(section_name(code, part))) key.hash(record->hash);
}

void ShardArtifact::add_ghost_hashes(std::uint64_t code, KeyHasher& key) const {
  for (const Part part : {ghost_cells, ghost_vertices, sheets_of_edges, ghost_apart, ghost_roots})
    if (const SectionRecord* record = file_.find(section_name(code, part))) key.hash(record->hash);
}

namespace {

template <class T>
void read_where_any(const ArtifactReader& file, std::uint64_t code, Part part,
                    std::vector<T>& out) {
  out.clear();
  if (file.find(section_name(code, part)) != nullptr)
    file.read_array(section_name(code, part), out);
}

void read_ghosts(const ArtifactReader& file, std::uint64_t code, GhostLayer& out) {
  file.read_array(section_name(code, ghost_cells), out.cells);
  file.read_array(section_name(code, ghost_vertices), out.vertices);
  read_where_any(file, code, sheets_of_edges, out.sheets_of_edges);
  read_where_any(file, code, ghost_apart, out.apart);
  read_where_any(file, code, ghost_roots, out.roots);
  if ((!out.sheets_of_edges.empty() && out.sheets_of_edges.size() != out.cells.size()) ||
      (!out.roots.empty() && out.roots.size() != out.vertices.size()))
    file.damaged("the parts of a ghost layer contradict each other");
}

std::uint64_t bytes_of_parts(const ArtifactReader& file, std::uint64_t code, std::uint64_t end) {
  std::uint64_t sum = 0;
  for (std::uint64_t part = vertices; part < end; ++part)
    if (const SectionRecord* record = file.find(section_name(code, part))) sum += record->size;
  return sum;
}

void read_stitched(const ArtifactReader& file, std::uint64_t code, BrickOctree& out) {
  file.read_array(section_name(code, vertices), out.vertices);
  file.read_array(section_name(code, polygons), out.polygons);
  read_where_any(file, code, emit_levels, out.emit_levels);
  read_where_any(file, code, pairs, out.pairs);
  read_where_any(file, code, polygon_pairs, out.polygon_pairs);
  read_where_any(file, code, roots, out.roots);
  file.read_array(section_name(code, blocks), out.blocks);
  read_ghosts(file, code, out.ghost);
  const auto beside_polygons = [&](std::size_t size) {
    return size == 0 || size == out.polygons.size();
  };
  const auto names_a_pair = [&](std::uint32_t place) { return place < out.pairs.size(); };
  if (out.blocks.empty() || out.blocks.back().polygon_end != out.polygons.size() ||
      !beside_polygons(out.emit_levels.size()) || !beside_polygons(out.polygon_pairs.size()) ||
      (!out.roots.empty() && out.roots.size() != out.vertices.size()) ||
      !std::all_of(out.polygon_pairs.begin(), out.polygon_pairs.end(), names_a_pair))
    file.damaged("the parts of a brick contradict each other");
}

}  // namespace

void ShardArtifact::read_brick(std::uint64_t code, BrickOctree& out) const {
  read_stitched(file_, code, out);
}

void ShardArtifact::read_ghost_layer(std::uint64_t code, GhostLayer& out) const {
  read_ghosts(file_, code, out);
}

std::uint64_t brick_bytes(const ArtifactReader& file, std::uint64_t code) {
  return bytes_of_parts(file, code, levels + 1);
}

void read_whole_brick(const ArtifactReader& file, std::uint64_t code, BrickOctree& out) {
  read_stitched(file, code, out);
  out.record = read_node_record(file, code);
  out.levels.clear();
  if (file.find(section_name(code, levels)) == nullptr) return;
  std::vector<std::byte> bytes;
  file.read(section_name(code, levels), bytes);
  LevelsSize size{static_cast<std::uint32_t>(out.vertices.size()), 0, 0};
  std::array<std::uint32_t, 2> sizes{};
  if (bytes.size() >= sizeof sizes) {
    std::memcpy(sizes.data(), bytes.data(), sizeof sizes);
    size.clusters = sizes[0];
    size.merges = sizes[1];
  }
  if (bytes.size() != sizeof sizes + size.bytes())
    file.damaged("the levels of a brick contradict themselves");
  out.levels = levels_of(std::span(bytes).subspan(sizeof sizes), size);
}

std::uint64_t ShardArtifact::brick_bytes(std::uint64_t code) const {
  return bytes_of_parts(file_, code, end_of_stitched);
}

}  // namespace voxweld
