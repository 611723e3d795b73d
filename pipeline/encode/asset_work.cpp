#include "pipeline/encode/asset_work.h"

#include <fmt/format.h>

#include <algorithm>

#include "pipeline/executor/probe.h"
#include "pipeline/executor/prompt_stop.h"
#include "stages/encode/adjacency.h"
#include "stages/encode/crop_mesh.h"
#include "stages/encode/label_boundary.h"
#include "stages/encode/mesh_accumulator.h"
#include "stages/encode/mesh_measure.h"
#include "stages/encode/mesh_writers.h"
#include "storage/artifact/asset_record.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

// What files say of a label.
void add_entry(KeyHasher& key, const MaterialEntry& entry) {
  key.integer(static_cast<std::int64_t>(entry.material)).text(entry.name);
  key.integer(entry.color ? 1 : 0);
  if (!entry.color) return;
  for (const std::uint8_t level : {entry.color->red, entry.color->green, entry.color->blue})
    key.integer(level);
}

// What files are made of beside the parameters: the mesh, and the names and colours its labels are
// given.
Hash128 content_of(const EncodeJob& job, const TileArtifact& tile) {
  if (!job.describes) return tile.content_hash();
  std::vector<Material> labels = tile.labels();
  for (const MaterialPair& pair : tile.read_label_pairs()) {
    labels.push_back(pair.inside);
    labels.push_back(pair.outside);
  }
  std::sort(labels.begin(), labels.end());
  labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
  KeyHasher key;
  key.hash(tile.content_hash());
  bool any = false;
  for (const Material label : labels) {
    const MaterialEntry* entry = job.materials->find(label);
    if (entry == nullptr || (!entry->color && entry->name.empty())) continue;
    any = true;
    add_entry(key, *entry);
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

// Of normals in a coarser tile. They are several degrees off the surface in the mean. With 8 bits
// they are a third of a degree off in addition, and files a tenth smaller than with the mesh's 10.
constexpr int level_normal_bits = 8;

Hash128 level_key(const EncodeJob& job, const LevelMeshes& levels, std::uint64_t node) {
  KeyHasher key;
  key.hash(job.key).text("level").hash(levels.content(node)).integer(level_normal_bits);
  if (job.describes)  // a coarse tile may have a part of any label
    for (const MaterialEntry& entry : job.materials->entries) add_entry(key, entry);
  return key.finish();
}

Hash128 merged_key(const EncodeJob& job, const UnitPlan& plan, MergedParts parts) {
  KeyHasher key;
  std::vector<Hash128> contents(plan.size());
  probe_all(plan.size(),
            [&](std::size_t i) { contents[i] = content_of(job, tile_of(job, plan, i)); });
  key.text("merged").hash(job.key);
  for (const Hash128& content : contents) key.hash(content);
  if (job.box) {
    key.text("box");
    for (int a = 0; a < 3; ++a) key.real(job.box->lo[a]).real(job.box->hi[a]);
  }
  if (parts != MergedParts::all) key.text("streamed");
  return key.finish();
}

AssetFacts facts_of(const RunContext& context, const EncodeJob& job, Material label) {
  AssetFacts facts;
  facts.encoding.normals = context.config.output.normals;
  facts.frame = job.frame;
  facts.materials = job.materials;
  facts.label = label;
  return facts;
}

// Draco's speed for surfaces of labels whose edges are not collapsed. Their normals turn too much from one
// vertex to the next to be predicted from positions: with EncodeParameters' own speed, files of
// connectomics and of the frog are 1 and 5 % larger, and take 1.15 and 1.25 times as long.
constexpr int rough_speed = 4;

// Of the mesh itself, not of coarser levels.
AssetFacts finest_facts(const RunContext& context, const EncodeJob& job, Material label) {
  AssetFacts facts = facts_of(context, job, label);
  if (is_of_labels(context.config) &&
      refine_mode(context.config) != SimplifyConfig::Refine::collapse)
    facts.encoding.encode_speed = facts.encoding.decode_speed = rough_speed;
  return facts;
}

// write(sink)
template <class Write>
FileRecord write_file(const EncodeJob& job, const std::string& stem, const MeshWriter& writer,
                      const Write& write) {
  AssetFile file(job.output, stem + std::string(writer.ending));
  write([&](std::span<const std::byte> bytes) { file.append(bytes); });
  return file.finish(std::string(writer.name));
}

// takes(writer): whether it is written in that format.
std::vector<FileRecord> write_formats(
    const EncodeJob& job, const TileMesh& mesh, const std::string& stem, const AssetFacts& facts,
    const WorkerContext& worker,
    const std::function<bool(const MeshWriter&)>& takes = [](const MeshWriter&) { return true; }) {
  Asset asset(mesh, facts);
  std::vector<FileRecord> files;
  for (const MeshWriter& writer : job.formats) {
    worker.check_interrupt();
    if (!takes(writer)) continue;
    files.push_back(
        write_file(job, stem, writer, [&](const ByteSink& sink) { writer.write(asset, sink); }));
  }
  return files;
}

// All but vertices, of which meshes may have some in common.
void add_counts(AssetRecord& record, const TileMesh& mesh) {
  record.triangles += mesh.triangles.size();
  record.quads += mesh.quads;
  record.polygon_triangles += mesh.polygon_triangles;
  record.collinear += mesh.collinear;
}

// Meshes of labels that lie on each other may have points in common.
std::uint64_t distinct_positions(const TileMesh& mesh) {
  std::vector<LatticePoint> points = mesh.positions;
  std::sort(points.begin(), points.end());
  return static_cast<std::uint64_t>(std::unique(points.begin(), points.end()) - points.begin());
}

// One more mesh of the record.
void add_mesh(AssetRecord& record, const TileMesh& mesh, const std::vector<FileRecord>& files) {
  record.vertices += mesh.positions.size();
  add_counts(record, mesh);
  if (!mesh.positions.empty()) {
    const LatticeBox box = LatticeBox::around(mesh.positions);
    if (!record.box) record.box = box;
    record.box->extend(box);
  }
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

[[noreturn]] void refuse_empty(const Bounds& box) {
  throw InputError(fmt::format(
      "no triangle of the mesh reaches into the box {},{},{} .. {},{},{}; the box is in the "
      "coordinates of the mesh files, lo before hi (`voxweld info` of a run's output folder says "
      "where its mesh lies)",
      box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z));
}

// The tiles that have triangles, as far as the box wants them.
EachTile tiles_of(const EncodeJob& job, const UnitPlan& plan, const WorkerContext& worker) {
  return [&](const std::function<void(const TileMesh&)>& f) {
    for (std::uint64_t unit = 0; unit < plan.size(); ++unit) {
      worker.check_interrupt();
      TileMesh tile = tile_of(job, plan, unit).read();
      if (job.box) tile = cropped(tile, job.box->lo, job.box->hi);
      if (!tile.triangles.empty()) f(tile);
    }
  };
}

TileMesh merged_mesh(const RunContext& context, const EncodeJob& job, const EachTile& each_tile) {
  MeshAccumulator accumulator;
  each_tile([&](const TileMesh& tile) { accumulator.append(tile); });
  TileMesh mesh = accumulator.take();
  const bool open = context.config.surface.border == SurfaceConfig::Border::open || job.box;
  if (open && mesh.pairs.empty()) split_fans(mesh);
  if (job.box && mesh.triangles.empty()) refuse_empty(*job.box);
  return mesh;
}

// Whether all that is written of them is the same.
bool same_asset(const TileMesh& a, const TileMesh& b) {
  return a.lattice == b.lattice && a.positions == b.positions && a.normals == b.normals &&
         a.triangles == b.triangles && a.corner_normals == b.corner_normals && a.pairs == b.pairs &&
         a.triangle_pairs == b.triangle_pairs;
}

// Where there is one tile and `merged` is its mesh, the files of that are the merged mesh's too,
// and need not be encoded again. None where that is not so, or the tile has no files.
std::vector<FileRecord> copies_of_only_tile(const EncodeJob& job, const UnitPlan& plan,
                                            const TileMesh& merged) {
  if (plan.size() != 1 || !unit_is_current(job, plan, 0)) return {};
  if (!same_asset(tile_of(job, plan, 0).read(), merged)) return {};
  const auto tile = read_asset_record(asset_record_path(job, plan, 0), RecordParts::files);
  if (!tile || tile->files.size() != job.formats.size()) return {};
  std::vector<FileRecord> files;
  for (std::size_t i = 0; i < job.formats.size(); ++i) {
    const FileRecord& from = tile->files[i];
    AssetFile copy(job.output, "mesh" + std::string(job.formats[i].ending));
    copy.append(read_whole_file(job.output / from.path));
    files.push_back(copy.finish(from.format));
    if (files.back().xxh3_128 != from.xxh3_128) return {};  // damaged since
  }
  return files;
}

// Where the mesh was not put together before, the record gets its counts too.
void stream_merged(const EncodeJob& job, const EachTile& each_tile, const WorkerContext& worker,
                   AssetRecord& record) {
  const bool counted = record.triangles > 0;
  const StreamTotals totals = totals_of([&](const auto& f) {
    each_tile([&](const TileMesh& tile) {
      if (!counted) add_counts(record, tile);
      f(tile);
    });
  });
  if (job.box && totals.triangles == 0) refuse_empty(*job.box);
  if (!counted) record.vertices = totals.vertices;  // tiles have some in common
  for (const MeshWriter& writer : job.formats) {
    worker.check_interrupt();
    if (!writer.is_streamed()) continue;
    record.files.push_back(write_file(job, "mesh", writer, [&](const ByteSink& sink) {
      writer.stream(each_tile, totals, sink);
    }));
  }
}

}  // namespace

TileArtifact tile_of(const EncodeJob& job, const UnitPlan& plan, std::uint64_t unit) {
  const auto& folder = job.refined.empty() ? job.stitch->folder : job.refined;
  return TileArtifact(tile_artifact_path(folder, plan, unit));
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
      files = write_formats(
          job, mesh, planned[i].stem,
          finest_facts(context, job, artifact.labels().empty() ? exterior : artifact.labels()[i]),
          worker);
    add_mesh(record, mesh, files);
    if (!mesh.pairs.empty()) add_boundaries(record, mesh);
    if (!artifact.labels().empty())
      record.labels.push_back(
          label_asset(artifact.labels()[i], mesh, planned[i].vertices, files.size()));
  }
  write_asset_record(asset_record_path(job, plan, unit), record, job.output);
}

void encode_level(const RunContext& context, const EncodeJob& job, const LevelMeshes& levels,
                  std::uint64_t node, const WorkerContext& worker) {
  const LevelNode& at = levels.tree().nodes()[node];
  const TileMesh mesh = levels.read(node);
  AssetRecord record;
  record.key = level_key(job, levels, node);
  std::vector<FileRecord> files;
  AssetFacts facts = facts_of(context, job, exterior);
  facts.encoding.normal_bits = level_normal_bits;
  if (!mesh.triangles.empty()) files = write_formats(job, mesh, level_stem(at), facts, worker);
  add_mesh(record, mesh, files);
  if (levels.tree().of_labels()) record.vertices = distinct_positions(mesh);
  write_asset_record(level_record_path(job.folder, at), record, job.output);
}

void encode_merged(const RunContext& context, const EncodeJob& job, const UnitPlan& plan,
                   MergedParts parts, const WorkerContext& worker) {
  // Nobody but the process that leads may leave its other units at once.
  std::optional<PromptStop> prompt;
  if (context.lock != nullptr && worker.interrupt() != nullptr)
    prompt.emplace(*worker.interrupt(), 0.8);
  AssetRecord record;
  record.key = merged_key(job, plan, parts);
  const EachTile each_tile = tiles_of(job, plan, worker);
  if (parts == MergedParts::all && !std::ranges::all_of(job.formats, &MeshWriter::is_streamed)) {
    const TileMesh mesh = merged_mesh(context, job, each_tile);
    std::vector<FileRecord> files = copies_of_only_tile(job, plan, mesh);
    const bool copied = !files.empty();
    if (!copied)
      files = write_formats(job, mesh, "mesh", finest_facts(context, job, exterior), worker,
                            [&](const MeshWriter& writer) { return !writer.is_streamed(); });
    add_mesh(record, mesh, files);
    if (copied) return write_asset_record(merged_record_path(job), record, job.output);
  }
  if (std::ranges::any_of(job.formats, &MeshWriter::is_streamed))
    stream_merged(job, each_tile, worker, record);
  write_asset_record(merged_record_path(job), record, job.output);
}

bool unit_is_current(const EncodeJob& job, const UnitPlan& plan, std::uint64_t unit) {
  const std::filesystem::path record = asset_record_path(job, plan, unit);
  if (!std::filesystem::exists(record)) return false;
  return asset_is_current(record, asset_key(job, plan, unit, tile_of(job, plan, unit)), job.output);
}

bool level_is_current(const EncodeJob& job, const LevelMeshes& levels, std::uint64_t node) {
  const std::filesystem::path record = level_record_path(job.folder, levels.tree().nodes()[node]);
  if (!std::filesystem::exists(record)) return false;
  return asset_is_current(record, level_key(job, levels, node), job.output);
}

bool merged_is_current(const EncodeJob& job, const UnitPlan& plan, MergedParts parts) {
  return asset_is_current(merged_record_path(job), merged_key(job, plan, parts), job.output);
}

}  // namespace voxweld
