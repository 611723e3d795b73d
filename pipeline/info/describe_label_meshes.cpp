// Plans by material, and what labels.mode = "each" leaves: tiles and the list of its labels.
#include "pipeline/info/kinds.h"
#include "storage/artifact/material_top.h"
#include "storage/artifact/tile_artifact.h"
#include "storage/manifest/manifest.h"

namespace voxweld {

namespace fs = std::filesystem;

void add_plan(InfoDocument& document, const MaterialTop& top, bool verbose) {
  const std::vector<BatchRecord> batches = top.batches();
  document["materials"] = top.surface_count();
  document["tiles"] = top.tile_count();
  document["batches"] = batches.size();
  if (!verbose) return;
  document["batch_list"] = InfoDocument::array();
  for (const BatchRecord& batch : batches)
    document["batch_list"].push_back({{"material", batch.material},
                                      {"materials", batch.surfaces},
                                      {"level", batch.tile_level},
                                      {"at", facts_of(batch.tile().at)},
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
  InfoDocument document = file_document("label_list", path);
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
