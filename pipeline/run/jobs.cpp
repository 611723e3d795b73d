#include "pipeline/run/jobs.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "pipeline/build/build_stage.h"
#include "pipeline/build/contour_parameters.h"
#include "pipeline/config/settings.h"
#include "pipeline/ingest/ingest_layout.h"
#include "pipeline/ingest/isovalue_choice.h"
#include "pipeline/ingest/label_choice.h"
#include "pipeline/ingest/noise_choice.h"
#include "pipeline/run/output_frame.h"
#include "pipeline/run/tile_vertices.h"
#include "pipeline/stage/unit_plan.h"
#include "storage/store/store_source.h"
#include "storage/support/error.h"
#include "storage/support/provenance.h"

namespace voxweld {
namespace {

void check_label(const Config& config, const VolumeInfo& info) {
  if (!config.surface.label && config.labels.mode == LabelMode::off) return;
  const std::string key =
      config.surface.label
          ? fmt::format("surface.label = {}", *config.surface.label)
          : fmt::format("labels.mode = {}", to_toml(*find_setting("labels", "mode")->get(config)));
  if (const std::string problem = no_labels_text(info); !problem.empty())
    throw InputError(
        fmt::format("{}: labels are integers as they are stored, {} {}; give a "
                    "surface.isovalue instead",
                    key, config.input.path.string(), problem));
}

// decode: what the source of the samples holds while it decodes, in bytes.
ShardMemory shard_memory(const Config& config, const VolumeInfo& info, std::uint64_t decode) {
  const bool replaces = std::ranges::any_of(
      config.edits, [](const EditConfig& edit) { return edit.op == EditOp::replace; });
  ShardMemory memory = shard_memory(brick_grid(config, info.geometry), info.type,
                                    {config.labels.mode, replaces, collapses_by_sheets(config)});
  memory.worker += decode;
  return memory;
}

}  // namespace

Jobs::Jobs(const Config& config, const InterruptFlag* interrupt) {
  // The ingest folder depends on the config alone.
  ingest_ = plan_ingest(config, stage_paths(config, VolumeInfo{}, {}).ingest, interrupt);
  check_label(config, ingest_.info);
  map_ = read_labels_map(config);
}

LabelParameters Jobs::chosen_labels(const Config& config) const {
  return voxweld::chosen_labels(config, map_);
}

void Jobs::open_volume(Config& config) {
  if (!config.surface.isovalue) {
    const IsovalueSuggestion chosen = choose_isovalue(config, ingest_);
    spdlog::info(
        "surface.isovalue = \"{}\": {}{}", isovalue_rule_name(config.surface.isovalue_rule),
        chosen.threshold.value,
        chosen.padding ? fmt::format(" (leaving out padding of {})", *chosen.padding) : "");
    config.surface.isovalue = chosen.threshold.value;
  }
  fit_tiles(config);
  if (asks_for_noise(config)) config.surface.noise = choose_noise(config, ingest_);
  const Volume volume = ingested_volume(config, ingest_);
  VolumeInfo info = volume.source->info();
  labels_ = final_labels(config, map_, ingest_);
  const OutputFrame output = output_frame(config, info.geometry);
  info.geometry = output.geometry;
  output_info_ = info;
  const StagePaths paths = stage_paths(config, info, labels_);
  build_.emplace(BuildJob{volume, brick_grid(config, info.geometry),
                          contour_parameters(config, volume.source->info(), volume.solid, labels_),
                          paths.build, paths.build_key,
                          shard_memory(config, info, info.largest_decode)});
  if (ingest_.mesh) build_->largest_bin = largest_bin(*ingest_.mesh);
  if (volume.ranges() == nullptr) build_->ranges = paths.ingest / "ranges";
  merge_ = {&*build_, paths.merge, paths.merge_key,
            static_cast<std::uint64_t>(planned_tile_vertices(config))};
  stitch_.build = &*build_;
  stitch_.merge = &merge_;
  stitch_.parameters.frame = output.volume;
  stitch_.parameters.first = output.first;
  stitch_.parameters.normals = config.output.normals;
  encode_ = {&stitch_, info.geometry, {}, config.output.directory, {}};
  encode_.materials = &map_.materials;
  encode_.formats = writers_named(mesh_writers(), config.output.formats);
  if (refines(config)) plan_refine(config, output);
  place_stages(paths);
  encode_.describes = std::ranges::any_of(encode_.formats, &MeshWriter::describes) &&
                      !map_.materials.entries.empty();
}

void Jobs::plan_refine(const Config& config, const OutputFrame& output) {
  const RefineFrame frame{output.volume};
  stitch_.cubes = frame;
  stitch_.parameters.aims = build_->parameters.simplify.overhang > 0;
  stitch_.parameters.normals = true;  // refine goes by them
  stitch_.parameters.triangle_notes = false;
  RefineParameters parameters;
  // Enumerators in the same order.
  parameters.intersections = static_cast<IntersectionRule>(config.simplify.intersections);
  parameters.tolerance = build_->parameters.simplify.tolerance / frame.lattice.step;
  parameters.reach =
      std::min({frame.spacing.x, frame.spacing.y, frame.spacing.z}) / frame.lattice.step;
  parameters.places = parameters.tolerance;
  if (build_->parameters.surface.border == Border::open) parameters.samples = sample_box(frame);
  mend_ = {Stage::mend, 0, 0, frame, parameters, {}, {}};
  mend_.parameters.mode = RefineMode::mend;
  refine_ = {Stage::refine, 0, 1, frame, parameters, {}, {}};
  if (only_repairs(config)) {
    // Near what was found first: most of it takes no more room.
    seams_ = mend_;
    seams_.stage = Stage::seams;
    seams_.room = {.cut = 0, .pass = 0, .cells = 1.5, .lengths = 0};
    seams_.parameters.mode = RefineMode::repair;
    mend_.room = {.walls = 2, .pass = 0, .lengths = 0.25};
  } else {
    seams_ = {Stage::seams, 1, 0, frame, parameters, {}, {}};
    mend_.room = {.walls = 2};
  }
  // What lay across borders of mend's boxes is to lie inside now, should these be cut again.
  remend_ = mend_;
  remend_.stage = Stage::remend;
  remend_.room.cut = 2;
  remend_.room.pass = 0;
  remend_.room.walls = 0;
  if (has_target(config)) {
    CollapseTarget target;
    if (config.simplify.triangles)
      target.triangles = static_cast<std::uint64_t>(*config.simplify.triangles);
    target.ratio = config.simplify.ratio.value_or(1);
    refine_.target = seams_.target = target;
    survey_ = {Stage::survey, 0, 1, frame, parameters, {}, {}};
    recount_ = {Stage::recount, 1, 0, frame, parameters, {}, {}};
  }
  retile_ = {frame,
             moved(frame.lattice, output.first),
             static_cast<std::uint64_t>(config.output.tile_vertices),
             config.output.normals,
             {},
             {}};
  levels_ = {frame, parameters, retile_.lattice, config.output.normals, config.output.levels,
             {},    {}};
}

void Jobs::place_stages(const StagePaths& paths) {
  const auto place = [](auto& job, const std::filesystem::path& folder, Hash128 key) {
    job.folder = folder;
    job.key = key;
  };
  place(stitch_, paths.stitch, paths.stitch_key);
  place(survey_, paths.survey, paths.survey_key);
  place(refine_, paths.refine, paths.refine_key);
  place(recount_, paths.recount, paths.recount_key);
  place(seams_, paths.seams, paths.seams_key);
  place(mend_, paths.mend, paths.mend_key);
  place(remend_, paths.remend, paths.remend_key);
  place(retile_, paths.retile, paths.retile_key);
  place(levels_, paths.levels, paths.levels_key);
  place(encode_, paths.encode, paths.encode_key);
  encode_.refined = paths.retile;
}

void Jobs::fit_cubes(const Config& config, std::uint64_t vertices) {
  // A closed surface has two triangles for a vertex.
  const double part =
      config.simplify.ratio.value_or(static_cast<double>(config.simplify.triangles.value_or(0)) /
                                     std::max(1.0, 2 * static_cast<double>(vertices)));
  const int level = target_cube_level(part, vertices, build_->grid.size());
  stitch_.cubes->level = level;
  for (RefineFrame* const frame : {&survey_.frame, &refine_.frame, &recount_.frame, &seams_.frame,
                                   &mend_.frame, &remend_.frame, &retile_.frame, &levels_.frame})
    frame->level = level;
  place_stages(stage_paths(config, output_info_, labels_, level));
}

void Jobs::set_tolerance(Stage stage, double tolerance) {
  RefineJob& job = stage == Stage::refine ? refine_ : seams_;
  job.parameters.tolerance = tolerance;
  if (stage == Stage::refine) recount_.parameters.tolerance = tolerance;
  if (stage == Stage::seams) levels_.parameters.tolerance = tolerance;
}

std::vector<std::filesystem::path> Jobs::later_folders() const {
  std::vector<std::filesystem::path> folders = {build_->folder, merge_.folder, stitch_.folder};
  if (stitch_.cubes) folders.insert(folders.end(), {refine_.folder, retile_.folder});
  if (!seams_.folder.empty()) folders.push_back(seams_.folder);
  if (!mend_.folder.empty()) folders.insert(folders.end(), {mend_.folder, remend_.folder});
  if (refine_.target) folders.insert(folders.end(), {survey_.folder, recount_.folder});
  if (!levels_.folder.empty()) folders.push_back(levels_.folder);
  folders.push_back(encode_.folder);
  return folders;
}

namespace {

// The lists of shards that stages keep are in memory whole.
void check_shards(const Config& config, const VolumeInfo& info) {
  constexpr double bytes_of_shard = 256;
  const Index3 shards = brick_grid(config, info.geometry).shards();
  const double count =
      static_cast<double>(shards.x) * static_cast<double>(shards.y) * static_cast<double>(shards.z);
  const double need = count * bytes_of_shard;
  if (need <= static_cast<double>(config.run.memory)) return;
  throw InputError(
      fmt::format("run.memory = {}: the volume of {} x {} x {} samples has {:.0f} shards, and the "
                  "lists of them "
                  "take about {}; raise run.memory, work.brick or work.shard",
                  exact_bytes(config.run.memory), info.geometry.size.x, info.geometry.size.y,
                  info.geometry.size.z, count, readable_bytes(need)));
}

}  // namespace

void check_budget(const RunContext& context, const Jobs& jobs) {
  const VolumeInfo& info = jobs.ingest().info;
  const Config& config = context.config;
  check_shards(config, info);
  // The samples may be copied first, to a store that is not there yet.
  const IngestJob& ingest = jobs.ingest();
  const std::uint64_t decode =
      ingest.copy ? store_decode_bytes(store_layout(config, ingest)) : info.largest_decode;
  std::vector<StageMemory> needs = {
      ingest_stage(config, jobs.ingest())->memory({}),
      build_memory(brick_grid(config, info.geometry), shard_memory(config, info, decode))};
  // The largest first: the figure it is refused with does for all.
  const auto bytes = [](const StageMemory& need) {
    return need.base_bytes + need.per_unit_bytes + need.per_worker_bytes;
  };
  std::sort(needs.begin(), needs.end(),
            [&](const StageMemory& a, const StageMemory& b) { return bytes(a) > bytes(b); });
  for (const StageMemory& need : needs) stage_threads(context, need);
}

namespace {

// Of many files some that are spread over all of them: a manifest stays small.
nlohmann::json files_json(const std::vector<InputFile>& files) {
  constexpr std::size_t most = 64;
  nlohmann::json out = nlohmann::json::array();
  const std::size_t count = std::min(files.size(), most);
  for (std::size_t i = 0; i < count; ++i) {
    const auto& [path, state] = files[count == 1 ? 0 : i * (files.size() - 1) / (count - 1)];
    out.push_back({{"path", path}, {"bytes", state.size}, {"modified_ns", state.mtime_ns}});
  }
  return out;
}

}  // namespace

namespace {

// Sums over all passes. But each of them counts what intersects, and how far points lie off, anew.
nlohmann::json refine_json(const Config& config, const Jobs& jobs, const RefineFigures& figures) {
  RefineCounts all = figures.refine;
  for (const RefineCounts& counts : figures.later) all.add(counts);
  const RefineCounts last = figures.last();
  const double step = jobs.refine().frame.lattice.step;
  nlohmann::json json = {{"mode", refine_name(refine_mode(config))},
                         {"tolerance", jobs.seams().parameters.tolerance * step},
                         {"collapses", all.collapses},
                         {"moves", all.moves},
                         {"flips", all.flips},
                         {"cubes", all.cubes},
                         {"intersecting_before", figures.refine.pairs_before},
                         {"intersecting_left", last.pairs_left},
                         {"worst", last.worst * step},
                         {"p99", last.quantile(0.99) * step},
                         {"unit", jobs.encode().frame.unit}};
  if (figures.target)
    json["target"] = {
        {"triangles", figures.target->target},
        {"before", figures.target->before},
        {"reached", figures.target->reached != 0},
        {"first_tolerance", jobs.refine().parameters.tolerance * step},
        {"tolerance_voxels", jobs.seams().parameters.tolerance / jobs.seams().parameters.reach}};
  return json;
}

}  // namespace

Manifest make_manifest(const RunContext& context, const Jobs& jobs, const TopArtifact& top,
                       const std::optional<RefineFigures>& refined) {
  const Config& config = context.config;
  const MergeCounts counts = top.counts();
  const VolumeInfo& info = jobs.ingest().info;
  const ContourParameters& parameters = jobs.build().parameters;
  Manifest m;
  m.lattice = moved(jobs.stitch().parameters.frame.lattice, jobs.stitch().parameters.first);
  m.open_border = parameters.surface.border == Border::open;
  m.free_topology = parameters.simplify.topology == Topology::free;
  m.labels = parameters.labels.mode;
  m.frame = jobs.encode().frame;
  m.counts.bricks = counts.bricks;
  m.counts.active_bricks = counts.active_bricks;
  m.counts.collapsed_above = counts.collapsed_above;
  m.counts.vertices = counts.vertices;
  const std::span<const std::uint64_t> leaves = counts.by_level.used_leaves();
  m.counts.leaves.assign(leaves.begin(), leaves.end());
  // A leaf at the border has a boundary vertex anywhere in it.
  if (m.open_border) {
    const Vec3& spacing = parameters.spacing;
    m.border_slack = (std::ldexp(1.0, static_cast<int>(leaves.size()) - 1) - 1) *
                     std::max({spacing.x, spacing.y, spacing.z});
  }
  m.input =
      std::make_unique<nlohmann::json>(nlohmann::json{{"path", config.input.path.string()},
                                                      {"format", info.format},
                                                      {"type", sample_type_name(info.type)},
                                                      {"files", files_json(jobs.ingest().files)}});
  if (!info.scale.identity()) {
    (*m.input)["slope"] = info.scale.slope;
    (*m.input)["intercept"] = info.scale.intercept;
  }
  if (config.surface.noise) (*m.input)["noise"] = *config.surface.noise;
  m.config = std::make_unique<nlohmann::json>(
      nlohmann::json{{"path", context.config_file.string()},
                     {"result", context.config_result ? to_hex(*context.config_result) : ""},
                     {"fingerprint", to_hex(config_fingerprint(config))},
                     {"toml", canonical_toml(config)}});
  m.error = std::make_unique<nlohmann::json>(
      nlohmann::json{{"metric", parameters.simplify.metric == Metric::rms ? "rms" : "sum"},
                     {"tolerance", parameters.simplify.tolerance},
                     {"reached", counts.by_level.worst_collapsed()},
                     {"finest", counts.by_level.errors[0]},
                     {"levels", counts.by_level.used_errors()},
                     {"unit", info.geometry.unit}});
  if (refined) {
    m.refine = std::make_unique<nlohmann::json>(refine_json(config, jobs, *refined));
    // Each collapse took a vertex.
    m.counts.vertices -= refined->refine.collapses;
    for (const RefineCounts& later : refined->later) m.counts.vertices -= later.collapses;
  }
  m.made_by = std::make_unique<nlohmann::json>(nlohmann::json::parse(provenance_json()));
  return m;
}

}  // namespace voxweld
