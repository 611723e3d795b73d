#include "pipeline/run/encode_stage.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "pipeline/executor/probe.h"
#include "pipeline/run/asset_record.h"
#include "pipeline/run/listing.h"
#include "pipeline/run/output_files.h"
#include "stages/encode/adjacency.h"
#include "stages/encode/draco_codec.h"
#include "stages/encode/glb.h"
#include "stages/encode/mesh_accumulator.h"
#include "stages/encode/pair_meshes.h"
#include "storage/artifact/tile_artifact.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

// Tiles keep their name in every run: level and index.
std::string tile_name(CellKey tile) {
  return fmt::format("{}-{}-{}-{}", tile.level, tile.at.x, tile.at.y, tile.at.z);
}

// Relative to the output directory. Folders by z and by y and x / 16, as the artifacts', only when
// there are too many for one.
std::string tile_stem(CellKey tile, bool many) {
  const std::filesystem::path root = "tiles";
  return (many ? fanned_out(root, tile.at, tile_name(tile)) : root / tile_name(tile)).string();
}

bool has_many(const std::vector<PlannedTile>& tiles) {
  return tiles.size() > 200;
}

std::filesystem::path tile_record_path(const EncodeJob& job, CellKey tile) {
  return fanned_out(job.folder, tile.at, tile_name(tile) + ".record");
}

std::filesystem::path merged_record_path(const EncodeJob& job) {
  return job.folder / "merged.record";
}

Hash128 content_of(const EncodeJob& job, CellKey tile) {
  return TileArtifact(tile_artifact_path(*job.stitch, tile)).content_hash();
}

Hash128 asset_key(const EncodeJob& job, Hash128 content) {
  return KeyHasher().hash(job.key).hash(content).finish();
}

Hash128 merged_key(const EncodeJob& job, const std::vector<PlannedTile>& tiles) {
  KeyHasher key;
  std::vector<Hash128> contents(tiles.size());
  probe_all(tiles.size(), [&](std::size_t i) { contents[i] = content_of(job, tiles[i].key()); });
  key.text("merged").hash(job.key);
  for (const Hash128& content : contents) key.hash(content);
  return key.finish();
}

// A primitive, and so a Draco buffer, for each pair of labels.
std::vector<std::byte> glb_by_pair(const TileMesh& mesh, const EncodeParameters& parameters,
                                   const GlbParameters& glb) {
  const std::vector<TileMesh> meshes = split_by_pair(mesh);
  std::vector<GlbPart> parts;
  for (std::size_t i = 0; i < meshes.size(); ++i)
    parts.push_back({encode_draco(meshes[i], parameters), mesh.pairs[i]});
  return wrap_glb(parts, glb);
}

// One Draco buffer serves both formats, but between labels.
std::vector<FileRecord> write_formats(const RunContext& context, const EncodeJob& job,
                                      const TileMesh& mesh, const std::string& stem) {
  EncodeParameters parameters;
  parameters.normals = context.config.output.normals;
  GlbParameters glb;
  glb.frame = job.frame;
  std::optional<EncodedMesh> whole;
  const auto encoded = [&]() -> const EncodedMesh& {
    if (!whole) whole = encode_draco(mesh, parameters);
    return *whole;
  };
  std::vector<FileRecord> files;
  for (const OutputConfig::Format format : context.config.output.formats) {
    if (format == OutputConfig::Format::drc)
      files.push_back(write_asset(job.output, stem + ".drc", "drc", encoded().bytes));
    else
      files.push_back(write_asset(
          job.output, stem + ".glb", "glb",
          mesh.pairs.empty() ? wrap_glb(encoded(), glb) : glb_by_pair(mesh, parameters, glb)));
  }
  return files;
}

AssetRecord record_of(Hash128 key, const TileMesh& mesh, std::vector<FileRecord> files) {
  return {key,
          mesh.positions.size(),
          mesh.triangles.size(),
          mesh.quads,
          mesh.polygon_triangles,
          mesh.collinear,
          std::move(files),
          {}};
}

void encode_tile(const RunContext& context, const EncodeJob& job, const PlannedTile& tile,
                 bool many) {
  const TileArtifact artifact(tile_artifact_path(*job.stitch, tile.key()));
  const TileMesh mesh = artifact.read();
  std::vector<FileRecord> files;
  // A tile may own polygons none of which has three leaves: it has no mesh, and no files.
  if (!mesh.triangles.empty() && context.config.output.tiles)
    files = write_formats(context, job, mesh, tile_stem(tile.key(), many));
  write_asset_record(tile_record_path(job, tile.key()),
                     record_of(asset_key(job, artifact.content_hash()), mesh, std::move(files)),
                     job.output);
}

void encode_merged(const RunContext& context, const EncodeJob& job,
                   const std::vector<PlannedTile>& tiles) {
  MeshAccumulator accumulator;
  for (const PlannedTile& tile : tiles) {
    if (context.interrupt != nullptr) context.interrupt->check();
    const TileMesh mesh = TileArtifact(tile_artifact_path(*job.stitch, tile.key())).read();
    if (!mesh.triangles.empty()) accumulator.append(mesh);
  }
  TileMesh mesh = accumulator.take();
  if (context.config.surface.border == SurfaceConfig::Border::open && mesh.pairs.empty())
    split_fans(mesh);
  write_asset_record(
      merged_record_path(job),
      record_of(merged_key(job, tiles), mesh, write_formats(context, job, mesh, "mesh")),
      job.output);
}

// The names of all that the run may write: the same for each of its tasks.
void add_planned(const RunContext& context, const std::vector<PlannedTile>& tiles, bool merged,
                 std::set<std::string>& names) {
  for (const OutputConfig::Format format : context.config.output.formats) {
    const char* ending = format == OutputConfig::Format::drc ? ".drc" : ".glb";
    for (const PlannedTile& tile : tiles)
      names.insert(tile_stem(tile.key(), has_many(tiles)) + ending);
    if (merged) names.insert(std::string("mesh") + ending);
  }
}

Hash128 planned_key(const EncodeJob& job, const TopArtifact& top, bool merged) {
  return KeyHasher().hash(job.key).hash(top.content_hash()).integer(merged ? 1 : 0).finish();
}

nlohmann::json stages_json(const RunContext& context) {
  nlohmann::json stages = nlohmann::json::array();
  for (const StageReport& report : context.reports)
    stages.push_back({{"stage", report.stage},
                      {"units", report.units},
                      {"ran", report.ran},
                      {"seconds", report.figures.wall_s},
                      {"peak_resident_bytes", report.figures.peak_resident}});
  return stages;
}

void write_listing(const EncodeJob& job, const std::vector<PlannedTile>& tiles, bool merged,
                   std::set<std::string> before, Manifest manifest) {
  Listing listing;
  for (const PlannedTile& tile : tiles)
    listing.tiles.push_back({tile.key(), tile_record_path(job, tile.key())});
  if (merged) listing.merged = merged_record_path(job);
  listing.output = job.output;
  write_listing(listing, std::move(before), std::move(manifest));
}

bool tile_is_current(const EncodeJob& job, const PlannedTile& tile) {
  if (!std::filesystem::exists(tile_record_path(job, tile.key()))) return false;
  return asset_is_current(tile_record_path(job, tile.key()),
                          asset_key(job, content_of(job, tile.key())), job.output);
}

bool merged_is_current(const EncodeJob& job, const std::vector<PlannedTile>& tiles) {
  return asset_is_current(merged_record_path(job), merged_key(job, tiles), job.output);
}

// The merged mesh takes the memory of the whole process: in this one it is made alone, after the
// tiles; elsewhere it is one more unit.
void encode_missing(RunContext& context, const EncodeJob& job,
                    const std::vector<PlannedTile>& tiles, const EncodeStatus& status,
                    bool merged_planned) {
  StageRun stage;
  stage.stage = "encode";
  stage.noun = "meshes";
  const bool merged_done = merged_planned && !status.merged_missing;
  stage.reused = context.selection.count(tiles.size()) - status.missing.size() +
                 (merged_done && context.selection.contains(tiles.size()) ? 1 : 0);
  stage.memory = encode_memory(context.config, tiles);
  stage.identity = job.folder.filename().string();
  stage.done = [&](const Unit& unit) {
    return unit.key < tiles.size() ? tile_is_current(job, tiles[unit.key])
                                   : merged_is_current(job, tiles);
  };
  const bool here = context.executor->in_process();
  std::vector<Unit> units;
  double polygons = 0;
  for (const std::uint64_t number : status.missing) {
    units.push_back({number, "tile " + tile_name(tiles[number].key()),
                     static_cast<double>(tiles[number].polygons)});
    polygons += units.back().weight;
  }
  if (status.merged_missing && !here) units.push_back({tiles.size(), "merged mesh", polygons});
  const StageMeter meter;
  run_stage(context, stage, units, stage_threads(context, stage.memory),
            [&](const Unit& unit, WorkerContext&) {
              encode_tile(context, job, tiles[unit.key], has_many(tiles));
            });
  if (!status.merged_missing || !here) return;
  encode_merged(context, job, tiles);
  StageReport& report = context.reports.back();
  report.figures = meter.read();
  ++report.ran;
  ++report.units;
}

}  // namespace

StageMemory encode_memory(const Config& config, const std::vector<PlannedTile>& tiles) {
  std::uint64_t need = 0;
  for (const PlannedTile& tile : tiles) {
    // A tile also refers to vertices beyond its border.
    const std::uint64_t v = tile.vertices + tile.vertices / 4, t = 2 * tile.polygons;
    need = std::max(need, stitch_bytes(v, tile.polygons) / 2 +
                              encode_memory_bytes(v, t, config.output.normals));
  }
  return {"encode", 0, need,
          fmt::format("one tile (output.tile_vertices = {})", config.output.tile_vertices),
          "raise run.memory or lower output.tile_vertices; what is finished is kept"};
}

MergedPlan plan_merged(const Config& config, const std::vector<PlannedTile>& tiles) {
  std::uint64_t vertices = 0, triangles = 0;
  for (const PlannedTile& tile : tiles) {
    vertices += tile.vertices;
    triangles += 2 * tile.polygons;
  }
  MergedPlan plan;
  if (config.output.merged == OutputConfig::Merged::never) return plan;
  plan.bytes = program_bytes() +
               accumulator_memory_bytes(vertices, triangles, config.output.normals) +
               encode_memory_bytes(vertices, triangles, config.output.normals);
  plan.write = plan.bytes <= config.run.memory;
  if (plan.write) return plan;
  const std::string figures =
      fmt::format("one mesh of {} triangles takes {} to encode, run.memory is {}", triangles,
                  readable_bytes(static_cast<double>(plan.bytes)), exact_bytes(config.run.memory));
  if (config.output.merged == OutputConfig::Merged::always)
    throw InputError("output.merged = true: " + figures +
                     "; raise run.memory, or leave output.merged = \"auto\" and use the tiles");
  plan.why_not = figures;
  return plan;
}

EncodeStatus encode_status(const RunContext& context, const EncodeJob& job,
                           const TopArtifact& top) {
  EncodeStatus status;
  const std::vector<PlannedTile> tiles = top.tiles();
  const auto missing = probe_which(tiles.size(), [&](std::size_t i) {
    return context.selection.contains(i) && !tile_is_current(job, tiles[i]);
  });
  status.missing.assign(missing.begin(), missing.end());
  if (context.selection.contains(tiles.size()) && plan_merged(context.config, tiles).write)
    status.merged_missing = !merged_is_current(job, tiles);
  return status;
}

void run_encode(RunContext& context, const EncodeJob& job, Manifest manifest) {
  const TopArtifact top(job.stitch->merge->path());
  const std::vector<PlannedTile> tiles = top.tiles();
  context.selection.check("encode", "tiles", tiles.size() + 1);
  const EncodeStatus status = encode_status(context, job, top);
  const MergedPlan merged = plan_merged(context.config, tiles);
  if (!merged.why_not.empty())
    spdlog::warn("no merged mesh: {}; the tiles are complete", merged.why_not);

  if (!status.current())
    begin_output(job.output, planned_key(job, top, merged.write),
                 [&](auto& names) { add_planned(context, tiles, merged.write, names); });
  encode_missing(context, job, tiles, status, merged.write);
  if (!context.selection.all()) return;
  manifest.stages = std::make_unique<nlohmann::json>(stages_json(context));
  write_listing(job, tiles, merged.write, files_of_earlier_runs(job.output), std::move(manifest));
}

}  // namespace voxweld
