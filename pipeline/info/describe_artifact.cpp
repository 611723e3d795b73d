// The artifacts of build, merge, stitch, retile and encode, and ingest's histogram and labels.
#include "pipeline/info/kinds.h"
#include "pipeline/info/label_survey.h"
#include "stages/filter/stored_value.h"
#include "storage/artifact/asset_record.h"
#include "storage/artifact/brick_ranges_artifact.h"
#include "storage/artifact/histogram_artifact.h"
#include "storage/artifact/noise_artifact.h"
#include "storage/artifact/piece_changes.h"
#include "storage/artifact/shard_artifact.h"
#include "storage/artifact/tile_artifact.h"
#include "storage/artifact/top_artifact.h"
#include "storage/spool/spool_record.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

// Of a tile's mesh: as a header or a record has them.
template <class Mesh>
void add_mesh_counts(InfoDocument& document, const Mesh& mesh) {
  document["vertices"] = mesh.vertices;
  document["triangles"] = mesh.triangles;
  document["quads"] = mesh.quads;
  document["polygon_triangles"] = mesh.polygon_triangles;
  document["collinear"] = mesh.collinear;
}

InfoDocument describe_octrees(const fs::path& path, const InfoOptions& options) {
  const ShardArtifact artifact(path);
  const ShardSummary summary = artifact.summary();
  InfoDocument document = artifact_document("octree", path, artifact, shard_version);
  document["input_hash"] = to_hex(summary.input);
  document["bricks"] = summary.bricks;
  document["active_bricks"] = summary.active_bricks;
  if (summary.unread > 0) document["unread_bricks"] = summary.unread;
  document["active_cells"] = summary.counts.active_cells;
  document["crossing_edges"] = summary.counts.crossing_edges;
  document["vertices"] = summary.counts.vertices;
  document["collapsed_above"] = summary.collapsed_above;
  add_level_facts(document, summary.counts.by_level);
  document["pieces"] = artifact.piece_count();
  document["nodes"] = artifact.node_count();
  if (!options.verbose) return document;
  document["piece_list"] = InfoDocument::array();
  artifact.each_piece([&](const PieceRecord& piece) {
    document["piece_list"].push_back({{"material", piece.key.material},
                                      {"brick", facts_of(morton_decode(piece.key.brick))},
                                      {"vertices", piece.vertices},
                                      {"polygons", piece.polygons},
                                      {"ghost_cells", piece.ghost_cells},
                                      {"bytes", piece.stitched_bytes()}});
  });
  return document;
}

InfoDocument describe_top(const fs::path& path, const InfoOptions& options) {
  const TopArtifact artifact(path);
  const MergeCounts counts = artifact.counts();
  InfoDocument document = artifact_document("top_tree", path, artifact, top_version);
  document["bricks"] = counts.bricks;
  document["active_bricks"] = counts.active_bricks;
  document["active_cells"] = counts.active_cells;
  document["crossing_edges"] = counts.crossing_edges;
  document["vertices"] = counts.vertices;
  document["collapsed_above"] = counts.collapsed_above;
  document["top_leaves"] = counts.top_leaves;
  add_level_facts(document, counts.by_level);
  add_plan(document, MaterialTop(artifact), options.verbose);
  return document;
}

InfoDocument describe_tile(const fs::path& path) {
  const TileArtifact artifact(path);
  InfoDocument document = artifact_document("tile", path, artifact, tile_version);
  if (!artifact.labels().empty()) {
    add_label_tiles(document, artifact);
    return document;
  }
  const TileHeader header = artifact.header();
  document["level"] = header.level;
  document["at"] = facts_of(header.key().at);
  add_mesh_counts(document, header);
  document["lattice"] = facts_of({header.step, static_cast<int>(header.bits), header.origin});
  return document;
}

InfoDocument describe_asset(const fs::path& path) {
  const auto record = read_asset_record(path);
  if (!record) throw DamagedArtifact(path.string(), "its contents are not an asset record");
  InfoDocument document = keyed_document("asset_record", path, record->key);
  add_mesh_counts(document, *record);
  for (const LabelAsset& asset : record->labels) document["labels"].push_back(asset.label);
  document["files"] = InfoDocument::array();
  for (const FileRecord& file : record->files)
    document["files"].push_back({{"path", file.path},
                                 {"format", file.format},
                                 {"bytes", file.bytes},
                                 {"xxh3_128", file.xxh3_128}});
  return document;
}

InfoDocument describe_histogram(const fs::path& path) {
  const HistogramArtifact artifact = read_histogram_artifact(path);
  InfoDocument document = keyed_document("histogram", path, artifact.key);
  document["type"] = sample_type_name(artifact.histogram.type);
  document["values"] = value_facts(artifact.histogram, std::nullopt);
  return document;
}

InfoDocument describe_noise(const fs::path& path) {
  const NoiseArtifact artifact = read_noise_artifact(path);
  InfoDocument document = keyed_document("noise", path, artifact.key);
  document["deviation"] = artifact.level;
  return document;
}

InfoDocument describe_brick_ranges(const fs::path& path, const InfoOptions& options) {
  const BrickRangesArtifact artifact = read_brick_ranges(path);
  InfoDocument document = keyed_document("brick_ranges", path, artifact.key);
  document["bricks"] = artifact.ranges.size();
  if (!options.verbose) return document;
  document["brick_list"] = InfoDocument::array();
  for (const BrickRange& range : artifact.ranges)
    document["brick_list"].push_back({{"brick", facts_of(morton_decode(range.brick))},
                                      {"lowest", range.lo},
                                      {"highest", range.hi},
                                      {"nans", range.range().any_nan}});
  return document;
}

InfoDocument describe_labels(const fs::path& path) {
  const LabelCounts counts(path);
  InfoDocument document = keyed_document("label_counts", path, counts.key());
  document["content_hash"] = to_hex(counts.content_hash());
  document["labels"] = label_facts(counts);
  return document;
}

// What keep or fill found.
InfoDocument describe_pieces(const fs::path& path) {
  const PieceChanges artifact(path);
  const PieceChangesSummary& summary = artifact.summary();
  InfoDocument document = artifact_document("pieces", path, artifact, piece_changes_version);
  const auto type = static_cast<SampleType>(summary.type);
  document["filter"] = summary.outside != 0 ? "fill" : "keep";
  document["size"] = facts_of(summary.size);
  document["type"] = sample_type_name(type);
  document["pieces"] = summary.pieces;
  document["changed_pieces"] = summary.changed_pieces;
  document["samples"] = summary.samples;
  document["changed_samples"] = summary.changed_samples;
  document["stored_isovalue"] = summary.isovalue;
  document["stored_value"] = stored_text(type, summary.value);
  return document;
}

InfoDocument describe_kind(const fs::path& path, const ArtifactHead& head,
                           const InfoOptions& options) {
  const std::string kind = head.name();
  if (kind == "octr") return describe_octrees(path, options);
  if (kind == "tops") return describe_top(path, options);
  if (kind == "tile") return describe_tile(path);
  if (kind == "cubm") return describe_cube_mesh(path, options);
  if (kind == "tpln") return describe_tile_plan(path, options);
  if (kind == "hist") return describe_histogram(path);
  if (kind == "nois") return describe_noise(path);
  if (kind == "rang") return describe_brick_ranges(path, options);
  if (kind == "srvy") return describe_collapse_survey(path, options);
  if (kind == "tolr") return describe_tolerance(path);
  if (kind == "lcnt") return describe_labels(path);
  if (kind == "pcch") return describe_pieces(path);
  if (kind == "mesh" || kind == "mbin" || kind == "mtab") return describe_mesh_pieces(path, kind);
  if (kind == "shrd") return describe_shard_record(path, options);
  if (kind == "spol") {
    const std::string name = path.string(), ending = spool_record_path("").string();
    if (!name.ends_with(ending))
      throw FormatError(
          name + ": the record of a spool under another name; expected it to end in " + ending);
    return describe_spool(name.substr(0, name.size() - ending.size()), options);
  }
  if (kind == "asst") return describe_asset(path);
  throw FormatError(
      path.string() + ": an artifact of kind \"" + kind +
      "\", which this version of voxweld does not know; use the version that wrote it");
}

}  // namespace

InfoDocument describe_artifact(const fs::path& path, const ArtifactHead& head,
                               const InfoOptions& options) {
  // Opening checks header and index whatever the kind, so that the message names what is wrong.
  const ArtifactReader opened(path, head.kind, head.version);
  CheckResult check;
  if (options.check) check.read(check_artifact(path, head));
  InfoDocument document = describe_kind(path, head, options);
  if (options.check && !document.contains("check")) document["check"] = check.facts();
  return document;
}

}  // namespace voxweld
