#include "storage/artifact/material_top.h"

#include "storage/artifact/node_record_bytes.h"
#include "storage/artifact/top_artifact.h"

namespace voxweld {
namespace {

constexpr std::uint64_t top_tables_section = 5, batches_section = 6;
constexpr std::uint64_t page_of(std::uint64_t table) {
  return table << 56;
}
constexpr std::uint64_t tiles_table = 2, surfaces_table = 3, nodes_table = 4, leaves_table = 5,
                        clusters_table = 6;
constexpr std::uint64_t clusters_section(std::uint64_t surface) {
  return page_of(clusters_table) | surface;
}

struct MaterialTopTables {
  std::uint64_t tiles = 0, surfaces = 0, nodes = 0, leaves = 0;
};

static_assert(std::has_unique_object_representations_v<PlannedTile> &&
              std::has_unique_object_representations_v<SurfaceRecord> &&
              std::has_unique_object_representations_v<SurfaceNode> &&
              std::has_unique_object_representations_v<BatchRecord> && sizeof(TopLeaf) == 48);

MaterialTopTables read_tables(const ArtifactReader& file) {
  return file.read_record<MaterialTopTables>(top_tables_section, "has no tables");
}

}  // namespace

MaterialTablesWriter::MaterialTablesWriter(const std::filesystem::path& path,
                                           const ArtifactStamp& stamp)
    : file_(path, stamp),
      tiles_(file_, page_of(tiles_table)),
      surfaces_(file_, page_of(surfaces_table)),
      nodes_(file_, page_of(nodes_table)),
      leaves_(file_, page_of(leaves_table)) {}

void MaterialTablesWriter::leaf(const TopLeaf& leaf) {
  leaves_.push(leaf);
  ++open_.leaves;
}

void MaterialTablesWriter::tile(const PlannedTile& tile) {
  tiles_.push(tile);
  ++open_.tiles;
  open_.vertices += tile.vertices;
  open_.polygons += tile.polygons;
}

void MaterialTablesWriter::node(const SurfaceNode& node) {
  nodes_.push(node);
  ++open_.nodes;
}

void MaterialTablesWriter::clusters(const ReducedNode& top) {
  ReducedNode links{{}, top.leaves, top.nodes, top.links, {}};
  for (ClusterLink& link : links.links) link.root = no_cluster;
  std::vector<std::byte> bytes;
  put_links(links, bytes);
  file_.section(clusters_section(surfaces_.size()), bytes);
}

void MaterialTablesWriter::end_surface(Material material) {
  open_.material = material;
  surfaces_.push(open_);
  open_ = {};
  open_.first_tile = tiles_.size();
  open_.first_node = nodes_.size();
  open_.first_leaf = leaves_.size();
}

void MaterialTablesWriter::end_surface(Material material, std::uint64_t vertices) {
  open_.vertices = vertices;
  end_surface(material);
}

void MaterialTablesWriter::batch(const BatchRecord& batch) {
  batches_.push_back(batch);
}

void MaterialTablesWriter::finish_pages() {
  tiles_.finish();
  surfaces_.finish();
  nodes_.finish();
  leaves_.finish();
}

Hash128 MaterialTablesWriter::finish_tables() {
  const MaterialTopTables tables{tiles_.size(), surfaces_.size(), nodes_.size(), leaves_.size()};
  file_.section(top_tables_section, as_record(tables));
  file_.section(batches_section, as_section(batches_));
  return file_.commit();
}

MaterialTop::MaterialTop(const TopArtifact& top) : MaterialTop(top.file()) {}

MaterialTop::MaterialTop(const ArtifactReader& file)
    : file_(file),
      tiles_(file_, page_of(tiles_table), read_tables(file_).tiles),
      surfaces_(file_, page_of(surfaces_table), read_tables(file_).surfaces),
      nodes_(file_, page_of(nodes_table), read_tables(file_).nodes),
      leaves_(file_, page_of(leaves_table), read_tables(file_).leaves) {}

std::vector<BatchRecord> MaterialTop::batches() const {
  return file_.read_array<BatchRecord>(batches_section);
}

std::vector<SurfaceNode> MaterialTop::nodes(const SurfaceRecord& surface, int cube_level,
                                            std::uint64_t begin, std::uint64_t end) const {
  const std::uint64_t cells = std::uint64_t{1} << (3 * cube_level);
  return nodes_.between(
      surface.first_node, surface.nodes,
      [&](const SurfaceNode& node) { return node.code + cells <= begin; },
      [&](const SurfaceNode& node) { return node.code >= end; });
}

ReducedNode MaterialTop::clusters(std::uint64_t surface) const {
  ReducedNode top;
  if (file_.find(clusters_section(surface)) == nullptr) return top;
  std::vector<std::byte> bytes;
  file_.read(clusters_section(surface), bytes);
  if (!RecordBytes(bytes).take_links(top)) file_.damaged("the links of its clusters are wrong");
  return top;
}

std::uint64_t MaterialTop::cluster_bytes(std::uint64_t surface) const {
  const SectionRecord* section = file_.find(clusters_section(surface));
  return section == nullptr ? 0 : section->size;
}

std::vector<TopLeaf> MaterialTop::leaves(const SurfaceRecord& surface, std::uint64_t begin,
                                         std::uint64_t end) const {
  return leaves_.between(
      surface.first_leaf, surface.leaves,
      [&](const TopLeaf& leaf) {
        return leaf.code + (std::uint64_t{1} << (3 * leaf.level)) <= begin;
      },
      [&](const TopLeaf& leaf) { return leaf.code >= end; });
}

}  // namespace voxweld
