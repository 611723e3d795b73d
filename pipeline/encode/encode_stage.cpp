#include "pipeline/encode/encode_stage.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "pipeline/encode/listing.h"
#include "pipeline/encode/output_files.h"
#include "pipeline/executor/probe.h"
#include "stages/encode/adjacency.h"
#include "stages/encode/draco_codec.h"
#include "stages/encode/glb.h"
#include "stages/encode/mesh_accumulator.h"
#include "stages/encode/mesh_measure.h"
#include "stages/encode/pair_meshes.h"
#include "storage/artifact/asset_record.h"
#include "storage/artifact/tile_artifact.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

LabelMode label_mode(const EncodeJob& job) {
  return job.stitch->build->parameters.labels.mode;
}

TileArtifact tile_of(const EncodeJob& job, const UnitPlan& plan, std::uint64_t unit) {
  return TileArtifact(tile_artifact_path(*job.stitch, plan, unit));
}

// What files are made of beside the parameters: the mesh, and the colours its labels are given.
Hash128 content_of(const EncodeJob& job, const TileArtifact& tile) {
  if (!job.coloured) return tile.content_hash();
  std::vector<Material> labels = tile.labels();
  for (const MaterialPair& pair : tile.read_label_pairs()) labels.push_back(pair.inside);
  std::sort(labels.begin(), labels.end());
  labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
  KeyHasher key;
  key.hash(tile.content_hash());
  bool any = false;
  for (const Material label : labels) {
    const MaterialEntry* entry = job.materials->find(label);
    if (entry == nullptr || !entry->color) continue;
    any = true;
    key.integer(static_cast<std::int64_t>(label));
    for (const std::uint8_t level : {entry->color->red, entry->color->green, entry->color->blue})
      key.integer(level);
  }
  return any ? key.finish() : tile.content_hash();
}

Hash128 asset_key(const EncodeJob& job, const UnitPlan& plan, std::uint64_t unit,
                  const TileArtifact& tile) {
  KeyHasher key;
  key.hash(job.key).hash(content_of(job, tile));
  if (plan.spread(unit)) key.text("spread");
  // The record says how many vertices each label's octree has there; of those that only polygons of
  // other tiles use the tile knows nothing.
  if (!tile.labels().empty())
    for (const PlannedMesh& mesh : plan.meshes(unit))
      key.integer(static_cast<std::int64_t>(mesh.vertices));
  return key.finish();
}

Hash128 merged_key(const EncodeJob& job, const UnitPlan& plan) {
  KeyHasher key;
  std::vector<Hash128> contents(plan.size());
  probe_all(plan.size(),
            [&](std::size_t i) { contents[i] = content_of(job, tile_of(job, plan, i)); });
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

// One Draco buffer serves both formats, but between labels. label: whose mesh it is, if of any.
std::vector<FileRecord> write_formats(const RunContext& context, const EncodeJob& job,
                                      const TileMesh& mesh, const std::string& stem,
                                      Material label) {
  EncodeParameters parameters;
  parameters.normals = context.config.output.normals;
  GlbParameters glb;
  glb.frame = job.frame;
  glb.materials = job.materials;
  glb.label = label;
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

// One more mesh of the record.
void add_mesh(AssetRecord& record, const TileMesh& mesh, const std::vector<FileRecord>& files) {
  record.vertices += mesh.positions.size();
  record.triangles += mesh.triangles.size();
  record.quads += mesh.quads;
  record.polygon_triangles += mesh.polygon_triangles;
  record.collinear += mesh.collinear;
  record.files.insert(record.files.end(), files.begin(), files.end());
}

LabelAsset label_asset(Material label, const TileMesh& mesh, std::uint64_t octree_vertices,
                       std::size_t files) {
  return {label,
          mesh.tile,
          octree_vertices,
          mesh.positions.size(),
          mesh.triangles.size(),
          mesh.quads,
          mesh.polygon_triangles,
          measure(mesh.positions, mesh.triangles),
          files};
}

void add_boundaries(AssetRecord& record, const TileMesh& mesh) {
  for (const LabelBoundary& boundary : measure_labels(mesh)) {
    LabelAsset& asset = record.labels.emplace_back();
    asset.label = boundary.label;
    asset.tile = mesh.tile;
    asset.octree_vertices = asset.vertices = boundary.vertices;
    asset.triangles = boundary.triangles;
    asset.measure = boundary.measure;
  }
}

void encode_unit(const RunContext& context, const EncodeJob& job, const UnitPlan& plan,
                 std::uint64_t unit, const WorkerContext& worker) {
  const TileArtifact artifact = tile_of(job, plan, unit);
  const std::vector<PlannedMesh> planned = plan.meshes(unit);
  if (artifact.meshes() != planned.size())
    throw DamagedArtifact(artifact.path(), "has other meshes than are planned");
  AssetRecord record;
  record.key = asset_key(job, plan, unit, artifact);
  for (std::size_t i = 0; i < planned.size(); ++i) {
    worker.check_interrupt();
    const TileMesh mesh = artifact.read(i);
    std::vector<FileRecord> files;
    // A tile may own polygons none of which has three leaves: it has no mesh, and no files.
    if (!mesh.triangles.empty() && context.config.output.tiles)
      files = write_formats(context, job, mesh, planned[i].stem,
                            artifact.labels().empty() ? exterior : artifact.labels()[i]);
    add_mesh(record, mesh, files);
    if (!mesh.pairs.empty()) add_boundaries(record, mesh);
    if (!artifact.labels().empty())
      record.labels.push_back(
          label_asset(artifact.labels()[i], mesh, planned[i].vertices, files.size()));
  }
  write_asset_record(asset_record_path(job, plan, unit), record, job.output);
}

void encode_merged(const RunContext& context, const EncodeJob& job, const UnitPlan& plan) {
  MeshAccumulator accumulator;
  for (std::uint64_t unit = 0; unit < plan.size(); ++unit) {
    if (context.interrupt != nullptr) context.interrupt->check();
    const TileMesh mesh = tile_of(job, plan, unit).read();
    if (!mesh.triangles.empty()) accumulator.append(mesh);
  }
  TileMesh mesh = accumulator.take();
  if (context.config.surface.border == SurfaceConfig::Border::open && mesh.pairs.empty())
    split_fans(mesh);
  AssetRecord record;
  record.key = merged_key(job, plan);
  add_mesh(record, mesh, write_formats(context, job, mesh, "mesh", exterior));
  write_asset_record(merged_record_path(job), record, job.output);
}

// The names of all that the run may write: the same for each of its tasks.
void add_planned(const RunContext& context, const UnitPlan& plan, bool merged, FileNames& names) {
  std::vector<std::string> endings;
  for (const OutputConfig::Format format : context.config.output.formats)
    endings.push_back(format == OutputConfig::Format::drc ? ".drc" : ".glb");
  for (std::uint64_t unit = 0; unit < plan.size(); ++unit)
    for (const PlannedMesh& mesh : plan.meshes(unit))
      for (const std::string& ending : endings) names.add(mesh.stem + ending);
  for (const std::string& ending : endings)
    if (merged) names.add("mesh" + ending);
  if (context.config.labels.mode != LabelMode::off) names.add(labels_name);
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

void write_listing(const EncodeJob& job, const UnitPlan& plan, bool merged, FileNames& earlier,
                   Manifest manifest) {
  Listing listing;
  for (std::uint64_t unit = 0; unit < plan.size(); ++unit)
    listing.tiles.push_back({plan.largest(unit).key(), asset_record_path(job, plan, unit)});
  if (merged) listing.merged = merged_record_path(job);
  listing.labels = label_mode(job);
  listing.materials = job.materials;
  listing.output = job.output;
  listing.scratch = job.folder;
  write_listing(listing, earlier, std::move(manifest));
}

bool unit_is_current(const EncodeJob& job, const UnitPlan& plan, std::uint64_t unit) {
  const std::filesystem::path record = asset_record_path(job, plan, unit);
  if (!std::filesystem::exists(record)) return false;
  return asset_is_current(record, asset_key(job, plan, unit, tile_of(job, plan, unit)), job.output);
}

bool merged_is_current(const EncodeJob& job, const UnitPlan& plan) {
  return asset_is_current(merged_record_path(job), merged_key(job, plan), job.output);
}

void count_label_pairs(const EncodeJob& job, const UnitPlan& plan, EncodeStatus& status) {
  if (label_mode(job) != LabelMode::shared) return;
  std::vector<std::uint64_t> counts(plan.size());
  probe_all(plan.size(), [&](std::size_t i) { counts[i] = tile_of(job, plan, i).label_pairs(); });
  for (const std::uint64_t count : counts) status.label_pairs += count;
  for (const std::uint64_t unit : status.missing)
    status.most_label_pairs = std::max(status.most_label_pairs, counts[unit]);
}

bool writes_glb(const Config& config) {
  const std::vector<OutputConfig::Format>& formats = config.output.formats;
  return std::find(formats.begin(), formats.end(), OutputConfig::Format::glb) != formats.end();
}

// A glTF primitive: its mesh apart, encoded, and described in JSON. On noise, where each polygon
// has a pair of its own, it took 8.6 KiB.
std::uint64_t label_pair_bytes(const Config& config, std::uint64_t pairs) {
  return pairs * (writes_glb(config) ? 12 * 1024 : 256);
}

// The merged mesh takes the memory of the whole process: in this one it is made alone, after the
// tiles; elsewhere it is one more unit.
void encode_missing(RunContext& context, const EncodeJob& job, const UnitPlan& plan,
                    const EncodeStatus& status, bool merged_planned) {
  StageRun stage;
  stage.stage = "encode";
  stage.noun = label_mode(job) == LabelMode::each ? "groups" : "meshes";
  const bool merged_done = merged_planned && !status.merged_missing;
  stage.reused = context.selection.count(plan.size()) - status.missing.size() +
                 (merged_done && context.selection.contains(plan.size()) ? 1 : 0);
  stage.memory = encode_memory(context.config, plan.largest_tiles());
  const std::uint64_t pairs = status.most_label_pairs;
  stage.memory.per_unit_bytes += label_pair_bytes(context.config, pairs);
  if (pairs > 0) stage.memory.unit += fmt::format(" with {} pairs of labels", pairs);
  if (pairs > 0 && writes_glb(context.config))
    stage.memory.advice =
        "raise run.memory, lower output.tile_vertices, or leave \"glb\", whose pairs are meshes of "
        "their own, out of output.formats; what is finished is kept";
  stage.identity = job.folder.filename().string();
  stage.done = [&](const Unit& unit) {
    return unit.key < plan.size() ? unit_is_current(job, plan, unit.key)
                                  : merged_is_current(job, plan);
  };
  const bool here = context.executor->in_process();
  std::vector<Unit> units;
  double polygons = 0;
  for (const std::uint64_t number : status.missing) {
    units.push_back({number, plan.name(number), static_cast<double>(plan.total(number).polygons)});
    polygons += units.back().weight;
  }
  if (status.merged_missing && !here) units.push_back({plan.size(), "merged mesh", polygons});
  const StageMeter meter;
  run_stage(context, stage, units, stage_threads(context, stage.memory),
            [&](const Unit& unit, WorkerContext& worker) {
              encode_unit(context, job, plan, unit.key, worker);
            });
  if (!status.merged_missing || !here) return;
  encode_merged(context, job, plan);
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

MergedPlan plan_merged(const Config& config, const UnitPlan& units, std::uint64_t label_pairs) {
  MergedPlan plan;
  // Closed surfaces of neighbouring labels overlap: they are no one mesh.
  if (config.labels.mode == LabelMode::each) return plan;
  std::uint64_t vertices = 0, triangles = 0;
  for (std::uint64_t unit = 0; unit < units.size(); ++unit) {
    const PlannedTile tile = units.total(unit);
    vertices += tile.vertices;
    triangles += 2 * tile.polygons;
  }
  if (config.output.merged == OutputConfig::Merged::never) return plan;
  plan.bytes = program_bytes() +
               accumulator_memory_bytes(vertices, triangles, config.output.normals) +
               encode_memory_bytes(vertices, triangles, config.output.normals) +
               label_pair_bytes(config, label_pairs);
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
  const auto plan = unit_plan(top, label_mode(job));
  const auto missing = probe_which(plan->size(), [&](std::size_t i) {
    return context.selection.contains(i) && !unit_is_current(job, *plan, i);
  });
  status.missing.assign(missing.begin(), missing.end());
  count_label_pairs(job, *plan, status);
  if (context.selection.contains(plan->size()) &&
      plan_merged(context.config, *plan, status.label_pairs).write)
    status.merged_missing = !merged_is_current(job, *plan);
  return status;
}

void run_encode(RunContext& context, const EncodeJob& job, Manifest manifest) {
  const TopArtifact top(job.stitch->merge->path());
  const auto plan = unit_plan(top, label_mode(job));
  context.selection.check("encode", "tiles", plan->size() + 1);
  const EncodeStatus status = encode_status(context, job, top);
  const MergedPlan merged = plan_merged(context.config, *plan, status.label_pairs);
  if (!merged.why_not.empty())
    spdlog::warn("no merged mesh: {}; the tiles are complete", merged.why_not);

  if (!status.current()) {
    FileNames names(job.folder);
    begin_output(job.output, planned_key(job, top, merged.write), names,
                 [&](FileNames& all) { add_planned(context, *plan, merged.write, all); });
  }
  encode_missing(context, job, *plan, status, merged.write);
  if (!context.selection.all()) return;
  manifest.stages = std::make_unique<nlohmann::json>(stages_json(context));
  FileNames earlier(job.folder);
  add_files_of_earlier_runs(job.output, earlier);
  write_listing(job, *plan, merged.write, earlier, std::move(manifest));
}

}  // namespace voxweld
