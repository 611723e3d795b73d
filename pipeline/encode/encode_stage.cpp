#include "pipeline/encode/encode_stage.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "pipeline/encode/asset_work.h"
#include "pipeline/encode/listing.h"
#include "pipeline/encode/output_files.h"
#include "pipeline/executor/probe.h"
#include "stages/encode/draco_codec.h"
#include "stages/encode/mesh_accumulator.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

LabelMode label_mode(const EncodeJob& job) {
  return job.stitch->build->parameters.labels.mode;
}

// The names of all that the run may write: the same for each of its tasks.
void add_planned(const EncodeJob& job, const UnitPlan& plan, bool merged, FileNames& names) {
  std::vector<std::string> endings;
  for (const MeshWriter& writer : job.formats) endings.emplace_back(writer.ending);
  for (std::uint64_t unit = 0; unit < plan.size(); ++unit)
    for (const PlannedMesh& mesh : plan.meshes(unit))
      for (const std::string& ending : endings) names.add(mesh.stem + ending);
  for (const std::string& ending : endings)
    if (merged) names.add("mesh" + ending);
  if (label_mode(job) != LabelMode::off) names.add(labels_name);
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

// The format that takes most for each pair of labels: formats are written one after the other.
const MeshWriter& costliest_of_pairs(const EncodeJob& job) {
  return *std::ranges::max_element(job.formats, {}, &MeshWriter::pair_bytes);
}

void count_label_pairs(const EncodeJob& job, const UnitPlan& plan, EncodeStatus& status) {
  if (label_mode(job) != LabelMode::shared) return;
  std::vector<std::uint64_t> counts(plan.size());
  probe_all(plan.size(), [&](std::size_t i) { counts[i] = tile_of(job, plan, i).label_pairs(); });
  const std::uint64_t one = costliest_of_pairs(job).pair_bytes;
  for (const std::uint64_t count : counts) status.label_pair_bytes += count * one;
  for (const std::uint64_t unit : status.missing)
    status.most_label_pairs = std::max(status.most_label_pairs, counts[unit]);
}

StageRun stage_of_tiles(const RunContext& context, const EncodeJob& job, const UnitPlan& plan,
                        const EncodeStatus& status, const MergedPlan& merged) {
  StageRun stage;
  stage.stage = "encode";
  stage.noun = label_mode(job) == LabelMode::each ? "groups" : "meshes";
  const bool merged_done = merged.write && !status.merged_missing;
  stage.reused = context.selection.count(plan.size()) - status.missing.size() +
                 (merged_done && context.selection.contains(plan.size()) ? 1 : 0);
  stage.memory = encode_memory(context.config, plan.largest_tiles());
  const std::uint64_t pairs = status.most_label_pairs;
  const MeshWriter& costliest = costliest_of_pairs(job);
  stage.memory.per_unit_bytes += pairs * costliest.pair_bytes;
  if (pairs > 0) stage.memory.unit += fmt::format(" with {} pairs of labels", pairs);
  if (pairs > 0 && job.formats.size() > 1)
    stage.memory.advice = fmt::format(
        "raise run.memory, lower output.tile_vertices, or leave \"{}\", which takes {} for each "
        "pair, out of output.formats; what is finished is kept",
        costliest.name, readable_bytes(static_cast<double>(costliest.pair_bytes)));
  stage.identity = job.folder.filename().string();
  stage.done = [&job, &plan](const Unit& unit) {
    return unit.key < plan.size() ? unit_is_current(job, plan, unit.key)
                                  : merged_is_current(job, plan);
  };
  return stage;
}

// How many units are under way at once where the merged mesh is one of them: tiles get what it
// leaves of run.memory, and no more than `tiles` of them are at work when it is done. Its files are
// those of the only tile where there is but one: then that comes first.
int threads_beside_merged(const RunContext& context, const StageMemory& memory,
                          const MergedPlan& merged, const UnitPlan& plan, int tiles) {
  if (plan.size() == 1) return 1;
  const std::uint64_t left = context.budget().total - merged.bytes;
  return static_cast<int>(
      std::min<std::uint64_t>(static_cast<std::uint64_t>(tiles), 1 + left / memory.per_unit_bytes));
}

// Adds the last stage's report to the one before, of the same stage.
void join_reports(std::vector<StageReport>& reports) {
  const StageReport last = reports.back();
  reports.pop_back();
  StageReport& sum = reports.back();
  sum.units += last.units;
  sum.ran += last.ran;
  sum.figures.wall_s += last.figures.wall_s;
  sum.figures.cpu_s += last.figures.cpu_s;
  sum.figures.peak_resident = std::max(sum.figures.peak_resident, last.figures.peak_resident);
}

// The merged mesh is one more unit, as long as all tiles together and so the first to begin. Where
// run.memory does not hold a tile beside it, several tiles are better made before it, side by side.
void encode_missing(RunContext& context, const EncodeJob& job, const UnitPlan& plan,
                    const EncodeStatus& status, const MergedPlan& merged) {
  StageRun stage = stage_of_tiles(context, job, plan, status, merged);
  std::vector<Unit> units;
  double polygons = 0;
  for (const std::uint64_t number : status.missing) {
    units.push_back({number, plan.name(number), static_cast<double>(plan.total(number).polygons)});
    polygons += units.back().weight;
  }
  const UnitWork work = [&](const Unit& unit, const WorkerContext& worker) {
    if (unit.key < plan.size()) return encode_unit(context, job, plan, unit.key, worker);
    encode_merged(context, job, plan, worker);
  };
  const int tiles = stage_threads(context, stage.memory);
  if (!status.merged_missing || !merged.write) return run_stage(context, stage, units, tiles, work);
  const Unit whole{plan.size(), "merged mesh", polygons};
  const int threads = context.executor->in_process()
                          ? threads_beside_merged(context, stage.memory, merged, plan, tiles)
                          : tiles;
  if (threads == 1 && tiles > 1 && units.size() > 1) {
    run_stage(context, stage, units, tiles, work);
    stage.reused = 0;
    run_stage(context, stage, {whole}, 1, work);
    return join_reports(context.reports);
  }
  units.push_back(whole);
  run_stage(context, stage, units, threads, work);
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

MergedPlan plan_merged(const Config& config, const UnitPlan& units, std::uint64_t pair_bytes) {
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
               encode_memory_bytes(vertices, triangles, config.output.normals) + pair_bytes;
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
      plan_merged(context.config, *plan, status.label_pair_bytes).write)
    status.merged_missing = !merged_is_current(job, *plan);
  return status;
}

void run_encode(RunContext& context, const EncodeJob& job, Manifest manifest) {
  const TopArtifact top(job.stitch->merge->path());
  const auto plan = unit_plan(top, label_mode(job));
  context.selection.check("encode", "tiles", plan->size() + 1);
  const EncodeStatus status = encode_status(context, job, top);
  const MergedPlan merged = plan_merged(context.config, *plan, status.label_pair_bytes);
  if (!merged.why_not.empty())
    spdlog::warn("no merged mesh: {}; the tiles are complete", merged.why_not);

  if (!status.current()) {
    FileNames names(job.folder);
    begin_output(job.output, planned_key(job, top, merged.write), names,
                 [&](FileNames& all) { add_planned(job, *plan, merged.write, all); });
  }
  encode_missing(context, job, *plan, status, merged);
  if (!context.selection.all()) return;
  manifest.stages = std::make_unique<nlohmann::json>(stages_json(context));
  FileNames earlier(job.folder);
  add_files_of_earlier_runs(job.output, earlier);
  write_listing(job, *plan, merged.write, earlier, std::move(manifest));
}

}  // namespace voxweld
