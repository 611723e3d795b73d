#include "storage/artifact/shard_artifact.h"

#include <algorithm>

namespace voxweld {
namespace {

enum Part : std::uint64_t {
  vertices = 1,
  polygons,
  emit_levels,
  blocks,
  skin_cells,
  skin_vertices,
  pairs,
  polygon_pairs,
  sheets_of_edges,
  end_of_parts
};
enum SummaryPart : std::uint64_t {
  summary_part = 1,
  nodes_part,
  cubes_part,
  leaves_part,
  bricks_part,
  runs_part
};
constexpr std::uint64_t summary_code = (std::uint64_t{1} << 56) - 1;

constexpr std::uint64_t section_name(std::uint64_t code, std::uint64_t part) {
  return code << 8 | part;
}

struct ShardSummaryRecord {
  std::uint64_t active_cells, crossing_edges, vertices, bricks, active_bricks, collapsed_above;
  double worst_residual, worst_finest;
  Hash128 input;
  std::array<std::uint64_t, max_levels + 1> leaves;
};

struct ShardNodeRecord {
  std::uint64_t code;
  std::uint64_t level;
  std::uint64_t polygons, cubes, leaves;
  RootRecord record;
};

// Records are written as they lie in memory, so none may have padding, which would carry whatever
// was there before.
static_assert(std::has_unique_object_representations_v<SkinCell> &&
              std::has_unique_object_representations_v<BlockCount> &&
              std::has_unique_object_representations_v<PolygonRefs> &&
              std::has_unique_object_representations_v<CubeCount> &&
              std::has_unique_object_representations_v<BuiltRun>);
static_assert(sizeof(LeafVertex) == 28 && sizeof(SkinVertex) == 32 && sizeof(TopLeaf) == 48 &&
              sizeof(RootRecord) == 8 + 52 + 36 + 28 + 4 + 64 &&
              std::has_unique_object_representations_v<MaterialPair> &&
              sizeof(ShardNodeRecord) == 40 + sizeof(RootRecord) &&
              sizeof(BrickCounts) == 8 * (3 + max_levels + 1) + 16 &&
              sizeof(BuiltBrick) == 24 + sizeof(RootRecord) + sizeof(BrickCounts));

template <class T>
std::span<const std::byte> bytes_of(const std::vector<T>& values) {
  return std::as_bytes(std::span(values));
}

}  // namespace

ShardArtifactWriter::ShardArtifactWriter(const std::filesystem::path& path, Hash128 key,
                                         Hash128 input_stamp)
    : file_(path, {shard_kind, shard_version, key}) {
  file_.set_input_stamp(input_stamp);
}

void ShardArtifactWriter::brick(std::uint64_t code, const BrickOctree& octree) {
  file_.section(section_name(code, vertices), bytes_of(octree.vertices));
  file_.section(section_name(code, polygons), bytes_of(octree.polygons));
  const auto where_any = [&](Part part, const auto& values) {
    if (!values.empty()) file_.section(section_name(code, part), bytes_of(values));
  };
  where_any(emit_levels, octree.emit_levels);
  where_any(pairs, octree.pairs);
  where_any(polygon_pairs, octree.polygon_pairs);
  where_any(sheets_of_edges, octree.skin.sheets_of_edges);
  file_.section(section_name(code, blocks), bytes_of(octree.blocks));
  file_.section(section_name(code, skin_cells), bytes_of(octree.skin.cells));
  file_.section(section_name(code, skin_vertices), bytes_of(octree.skin.vertices));
}

void ShardArtifactWriter::brick(std::uint64_t code, const ShardArtifact& from) {
  // In the order of the other one, so that the same bricks are the same file.
  for (const Part part : {vertices, polygons, emit_levels, pairs, polygon_pairs, sheets_of_edges,
                          blocks, skin_cells, skin_vertices}) {
    const std::uint64_t name = section_name(code, part);
    if (from.file_.find(name) == nullptr) continue;
    from.file_.read(name, section_);
    file_.section(name, section_);
  }
}

void write_summary(ArtifactWriter& file, const ShardSummary& s) {
  const ShardSummaryRecord record{s.counts.active_cells,
                                  s.counts.crossing_edges,
                                  s.counts.vertices,
                                  s.bricks,
                                  s.active_bricks,
                                  s.collapsed_above,
                                  s.counts.worst_residual,
                                  s.counts.worst_finest,
                                  s.input,
                                  s.counts.leaves};
  file.section(section_name(summary_code, summary_part), std::as_bytes(std::span(&record, 1)));
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
  file_.section(section_name(summary_code, nodes_part), bytes_of(node_records));
  file_.section(section_name(summary_code, cubes_part), bytes_of(cubes));
  file_.section(section_name(summary_code, leaves_part), bytes_of(leaves));
  file_.section(section_name(summary_code, bricks_part), bytes_of(history.bricks));
  file_.section(section_name(summary_code, runs_part), bytes_of(history.runs));
  return file_.commit();
}

ShardArtifact::ShardArtifact(const std::filesystem::path& path)
    : file_(path, shard_kind, shard_version) {}

ShardSummary ShardArtifact::summary() const {
  return read_summary(file_);
}

ShardSummary read_summary(const ArtifactReader& file) {
  std::vector<ShardSummaryRecord> records;
  file.read_array(section_name(summary_code, summary_part), records);
  if (records.size() != 1) file.damaged("has no summary");
  const ShardSummaryRecord& r = records[0];
  ShardSummary s;
  s.counts.active_cells = r.active_cells;
  s.counts.crossing_edges = r.crossing_edges;
  s.counts.vertices = r.vertices;
  s.counts.worst_residual = r.worst_residual;
  s.counts.worst_finest = r.worst_finest;
  s.counts.leaves = r.leaves;
  s.bricks = r.bricks;
  s.active_bricks = r.active_bricks;
  s.collapsed_above = r.collapsed_above;
  s.input = r.input;
  return s;
}

std::vector<ShardNode> ShardArtifact::nodes() const {
  std::vector<ShardNodeRecord> records;
  std::vector<CubeCount> cubes;
  std::vector<TopLeaf> leaves;
  file_.read_array(section_name(summary_code, nodes_part), records);
  file_.read_array(section_name(summary_code, cubes_part), cubes);
  file_.read_array(section_name(summary_code, leaves_part), leaves);
  std::vector<ShardNode> nodes;
  auto cube = cubes.begin();
  auto leaf = leaves.begin();
  for (const ShardNodeRecord& r : records) {
    if (r.level > max_levels || r.cubes > static_cast<std::uint64_t>(cubes.end() - cube) ||
        r.leaves > static_cast<std::uint64_t>(leaves.end() - leaf))
      file_.damaged("its summary contradicts itself");
    ShardNode node;
    node.key = {static_cast<int>(r.level), morton_decode(r.code >> (3 * r.level))};
    node.record = r.record;
    node.polygons = r.polygons;
    node.cubes.assign(cube, cube + static_cast<std::ptrdiff_t>(r.cubes));
    node.leaves.assign(leaf, leaf + static_cast<std::ptrdiff_t>(r.leaves));
    cube += static_cast<std::ptrdiff_t>(r.cubes);
    leaf += static_cast<std::ptrdiff_t>(r.leaves);
    nodes.push_back(std::move(node));
  }
  return nodes;
}

ShardHistory ShardArtifact::history() const {
  ShardHistory history;
  file_.read_array(section_name(summary_code, bricks_part), history.bricks);
  file_.read_array(section_name(summary_code, runs_part), history.runs);
  return history;
}

std::vector<BlockCount> ShardArtifact::block_counts(std::uint64_t code) const {
  std::vector<BlockCount> counts;
  file_.read_array(section_name(code, blocks), counts);
  return counts;
}

bool ShardArtifact::has_brick(std::uint64_t code) const {
  return file_.find(section_name(code, vertices)) != nullptr;
}

void ShardArtifact::add_brick_hashes(std::uint64_t code, KeyHasher& key) const {
  for (std::uint64_t part = vertices; part < end_of_parts; ++part)
    if (const SectionRecord* record = file_.find(section_name(code, part))) key.hash(record->hash);
}

void ShardArtifact::add_skin_hashes(std::uint64_t code, KeyHasher& key) const {
  for (const Part part : {skin_cells, skin_vertices, sheets_of_edges})
    if (const SectionRecord* record = file_.find(section_name(code, part))) key.hash(record->hash);
}

void ShardArtifact::read_brick(std::uint64_t code, BrickOctree& out) const {
  file_.read_array(section_name(code, vertices), out.vertices);
  file_.read_array(section_name(code, polygons), out.polygons);
  read_where_any(code, emit_levels, out.emit_levels);
  read_where_any(code, pairs, out.pairs);
  read_where_any(code, polygon_pairs, out.polygon_pairs);
  file_.read_array(section_name(code, blocks), out.blocks);
  read_skin(code, out.skin);
  const auto beside_polygons = [&](std::size_t size) {
    return size == 0 || size == out.polygons.size();
  };
  const auto names_a_pair = [&](std::uint32_t place) { return place < out.pairs.size(); };
  if (out.blocks.empty() || out.blocks.back().polygon_end != out.polygons.size() ||
      !beside_polygons(out.emit_levels.size()) || !beside_polygons(out.polygon_pairs.size()) ||
      !std::all_of(out.polygon_pairs.begin(), out.polygon_pairs.end(), names_a_pair))
    file_.damaged("the parts of a brick contradict each other");
}

template <class T>
void ShardArtifact::read_where_any(std::uint64_t code, std::uint64_t part,
                                   std::vector<T>& out) const {
  out.clear();
  if (file_.find(section_name(code, part)) != nullptr)
    file_.read_array(section_name(code, part), out);
}

void ShardArtifact::read_skin(std::uint64_t code, Skin& out) const {
  file_.read_array(section_name(code, skin_cells), out.cells);
  file_.read_array(section_name(code, skin_vertices), out.vertices);
  read_where_any(code, sheets_of_edges, out.sheets_of_edges);
  if (!out.sheets_of_edges.empty() && out.sheets_of_edges.size() != out.cells.size())
    file_.damaged("the parts of a skin contradict each other");
}

std::uint64_t ShardArtifact::brick_bytes(std::uint64_t code) const {
  std::uint64_t sum = 0;
  for (std::uint64_t part = vertices; part < end_of_parts; ++part)
    if (const SectionRecord* record = file_.find(section_name(code, part))) sum += record->size;
  return sum;
}

}  // namespace voxweld
