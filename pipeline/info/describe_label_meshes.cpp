// What labels.mode = "each" leaves: octrees, plans, tiles and the list of its labels.
#include "pipeline/info/kinds.h"
#include "storage/artifact/label_shard_artifact.h"
#include "storage/artifact/label_top.h"
#include "storage/artifact/tile_artifact.h"
#include "storage/manifest/manifest.h"

namespace voxweld {

namespace fs = std::filesystem;

InfoDocument describe_label_octrees(const fs::path& path, const InfoOptions& options) {
  const LabelShardArtifact artifact(path);
  const ShardSummary summary = artifact.summary();
  InfoDocument document = new_document("label_octrees", path);
  document["bytes"] = fs::file_size(path);
  document["key"] = to_hex(artifact.key());
  document["content_hash"] = to_hex(artifact.content_hash());
  document["version"] = label_shard_version;
  document["made_by"] = InfoDocument::parse(artifact.provenance(), nullptr, false);
  document["input_hash"] = to_hex(summary.input);
  document["bricks"] = summary.bricks;
  document["active_bricks"] = summary.active_bricks;
  document["active_cells"] = summary.counts.active_cells;
  document["crossing_edges"] = summary.counts.crossing_edges;
  document["vertices"] = summary.counts.vertices;
  document["collapsed_above"] = summary.collapsed_above;
  document["worst_residual"] = summary.counts.worst_residual;
  document["leaves"] = level_facts(summary.counts.leaves);
  document["pieces"] = artifact.piece_count();
  document["nodes"] = artifact.node_count();
  if (!options.verbose) return document;
  document["piece_list"] = InfoDocument::array();
  artifact.each_piece([&](const PieceRecord& piece) {
    document["piece_list"].push_back({{"label", piece.key.material},
                                      {"brick", facts_of(morton_decode(piece.key.brick))},
                                      {"vertices", piece.vertices},
                                      {"polygons", piece.polygons},
                                      {"ghost_cells", piece.ghost_cells},
                                      {"bytes", piece.body_bytes() + piece.ghost_bytes()}});
  });
  return document;
}

void add_label_plan(InfoDocument& document, const TopArtifact& artifact, bool verbose) {
  const LabelTop top(artifact);
  const std::vector<BatchRecord> batches = top.batches();
  document["labels"] = top.surface_count();
  document["tiles"] = top.tile_count();
  document["batches"] = batches.size();
  if (!verbose) return;
  document["batch_list"] = InfoDocument::array();
  for (const BatchRecord& batch : batches)
    document["batch_list"].push_back({{"label", batch.material},
                                      {"labels", batch.surfaces},
                                      {"tiles", batch.tiles},
                                      {"vertices", batch.vertices},
                                      {"polygons", batch.polygons}});
}

void add_label_tiles(InfoDocument& document, const TileArtifact& artifact) {
  document["meshes"] = InfoDocument::array();
  for (std::size_t i = 0; i < artifact.meshes(); ++i) {
    const TileHeader header = artifact.header(i);
    document["meshes"].push_back({{"label", artifact.labels()[i]},
                                  {"level", header.level},
                                  {"at", facts_of(header.key().at)},
                                  {"vertices", header.vertices},
                                  {"triangles", header.triangles}});
  }
}

InfoDocument describe_label_list(const fs::path& path, const InfoOptions& options) {
  InfoDocument document = new_document("label_list", path);
  document["bytes"] = fs::file_size(path);
  std::uint64_t labels = 0, tiles = 0, vertices = 0, triangles = 0;
  double volume = 0, area = 0;
  InfoDocument list = InfoDocument::array();
  LabelListReader reader(path);
  while (const auto label = reader.next()) {
    ++labels;
    tiles += label->tiles;
    vertices += label->vertices;
    triangles += label->triangles;
    volume += label->volume.value_or(0);
    area += label->area;
    if (options.verbose)
      list.push_back({{"label", label->label},
                      {"name", label->name},
                      {"triangles", label->triangles},
                      {"volume", label->volume.value_or(0)},
                      {"area", label->area}});
  }
  document["labels"] = labels;
  document["tiles"] = tiles;
  document["vertices"] = vertices;
  document["triangles"] = triangles;
  document["volume"] = volume;
  document["area"] = area;
  if (options.verbose) document["label_list"] = list;
  return document;
}

}  // namespace voxweld
