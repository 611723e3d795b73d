#include "pipeline/encode/encode_stage.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>

#include "pipeline/encode/level_listing.h"
#include "pipeline/encode/listing.h"
#include "pipeline/encode/output_files.h"
#include "pipeline/encode/tileset.h"
#include "pipeline/executor/probe.h"
#include "stages/encode/draco_codec.h"
#include "stages/encode/mesh_accumulator.h"
#include "storage/support/directory_lock.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

LabelMode label_mode(const EncodeJob& job) {
  return job.stitch->build->parameters.labels.mode;
}

// Calls f with the names of all that the run may write: the same for each of its tasks.
void each_planned(const EncodeJob& job, const UnitPlan& plan, const LevelMeshes* levels,
                  const MergedPlan& merged, const std::function<void(const std::string&)>& f) {
  std::vector<std::string> endings;
  for (const MeshWriter& writer : job.formats) {
    const std::string& ending = endings.emplace_back(writer.ending);
    if (merged.write && (merged.parts == MergedParts::all || writer.is_streamed()))
      f("mesh" + ending);
  }
  if (label_mode(job) != LabelMode::off) f(labels_name);
  if (std::ranges::find(job.formats, "vtp", &MeshWriter::name) != job.formats.end()) f(pieces_name);
  for (std::uint64_t unit = 0; unit < plan.size(); ++unit)
    for (const PlannedMesh& mesh : plan.meshes(unit))
      for (const std::string& ending : endings) f(mesh.stem + ending);
  if (levels == nullptr) return;
  f(tileset_name);
  const LevelTree& tree = levels->tree();
  const std::vector<bool> nested = nested_tilesets(tree);
  for (std::uint64_t n = 0; n < tree.nodes().size(); ++n) {
    for (const std::string& ending : endings) f(level_stem(tree.nodes()[n]) + ending);
    if (nested[n]) f(tileset_name_of(tree.nodes()[n]));
  }
}

// That nothing is in the way which no run is known to have written. Precondition: none of the units
// is there.
void check_strangers(const EncodeJob& job) {
  if (has_run(job.output) || !std::filesystem::exists(job.output)) return;
  each_of_our_form(job.output, [&](const std::string& name) {
    throw InputError(fmt::format(
        "{}: is in the way, and no run of voxweld is known to have written it; choose another "
        "output.directory, or give --force to write over it",
        (job.output / name).string()));
  });
}

Hash128 planned_key(const EncodeJob& job, Hash128 planned, bool merged, std::uint64_t nodes) {
  KeyHasher key;
  key.hash(job.key).hash(planned).integer(merged ? 1 : 0);
  if (nodes > 0) key.text("levels").integer(static_cast<std::int64_t>(nodes));
  return key.finish();
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

// Of tiles between labels: how many pairs each lists.
std::vector<std::uint64_t> label_pairs_of(const EncodeJob& job, const UnitPlan& plan) {
  if (label_mode(job) != LabelMode::shared) return {};
  std::vector<std::uint64_t> counts(plan.size());
  probe_all(plan.size(), [&](std::size_t i) { counts[i] = tile_of(job, plan, i).label_pairs(); });
  return counts;
}

// The format that takes most for each pair of labels: formats are written one after the other.
const MeshWriter& costliest_of_pairs(const EncodeJob& job) {
  return *std::ranges::max_element(job.formats, {}, &MeshWriter::pair_bytes);
}

std::uint64_t sum(const std::vector<std::uint64_t>& values) {
  return std::accumulate(values.begin(), values.end(), std::uint64_t{0});
}

// A tile also refers to vertices beyond its border.
std::uint64_t vertices_with_border(const PlannedTile& tile) {
  return tile.vertices + tile.vertices / 4;
}

std::uint64_t streaming_bytes(const PlannedTile& tile) {
  const std::uint64_t vertices = vertices_with_border(tile);
  return stitch_bytes(vertices, tile.polygons) / 2 + stream_bytes(vertices);
}

// What the merged mesh takes in memory, held as a whole or tile by tile.
struct MergedSizes {
  std::uint64_t triangles = 0, whole = 0, streamed = 0;
};
MergedSizes merged_sizes(const Config& config, const UnitPlan& units) {
  const bool normals = config.output.normals, labels = config.labels.mode == LabelMode::shared;
  MergedSizes sizes;
  std::uint64_t vertices = 0, largest = 0, kept = 0;
  for (std::uint64_t unit = 0; unit < units.size(); ++unit) {
    const PlannedTile tile = units.total(unit);
    vertices += tile.vertices;
    sizes.triangles += 2 * tile.polygons;
    largest = std::max(largest, streaming_bytes(tile));
    kept += TileWelder::kept_bytes(tile.vertices, labels);
  }
  sizes.whole = accumulator_memory_bytes(vertices, sizes.triangles, normals) +
                encode_memory_bytes(vertices, sizes.triangles, normals, labels);
  sizes.streamed = largest + kept;
  return sizes;
}

// How the message ends that something of the merged mesh is left out.
std::string what_there_is(const MergedPlan& merged, const EncodeJob& job) {
  std::string names;
  for (const MeshWriter& writer : job.formats)
    if (merged.write && writer.is_streamed())
      names += fmt::format("{}mesh{}", names.empty() ? "" : ", ", writer.ending);
  if (!names.empty()) return fmt::format("the tiles and {} are complete", names);
  return "the tiles are complete, and output.formats may have \"ply\", which takes little memory "
         "at any size";
}

// More than there is: the unit waits until nobody else has any.
constexpr std::uint64_t all_memory = std::numeric_limits<std::uint64_t>::max();

// The tiles as the plan has them, then the merged mesh where there is to be one: as long as all
// tiles together, so it begins first, and tiles get what it leaves of run.memory. Of one tile alone
// it has the same files: then it comes after it. Last the tiles of coarser levels.
class EncodeStage final : public StageWork {
 public:
  explicit EncodeStage(EncodeInputs inputs)
      : config_(inputs.config),
        job_(inputs.job),
        planned_(inputs.planned),
        plan_(inputs.plan),
        levels_(inputs.levels),
        manifest_(std::move(inputs.manifest)),
        pairs_(label_pairs_of(job_, plan_)),
        merged_(plan_merged(config_, plan_, pair_bytes(sum(pairs_)))) {}

  Stage stage() const override { return Stage::encode; }
  std::string noun() const override { return plan_.of_labels() ? "groups" : "tiles"; }
  std::string identity() const override { return job_.folder.filename().string(); }
  std::uint64_t size() const override {
    return first_node() + (levels_ == nullptr ? 0 : levels_->tree().nodes().size());
  }
  std::optional<std::uint64_t> apart() const override {
    return merged_.write ? std::optional(plan_.size()) : std::nullopt;
  }
  std::vector<Unit> units(std::span<const std::uint64_t> numbers) const override;
  bool done(std::uint64_t unit) override {
    if (is_node(unit)) return level_is_current(job_, *levels_, unit - first_node());
    return is_merged(unit) ? merged_is_current(job_, plan_, merged_.parts)
                           : unit_is_current(job_, plan_, unit);
  }
  StageLook look(const UnitSelection& selection) override;
  std::string missing_text(const StageLook& look) const override;

  StageMemory memory(std::span<const std::uint64_t> numbers) override;
  std::uint64_t bytes(std::uint64_t unit) override;
  void check(const RunContext& context, const StageLook& look) const override;
  void open(RunContext& context, const StageLook& look) override;
  void begin(RunContext& context, std::span<const std::uint64_t>, int) override {
    context_ = &context;
  }
  void run(const Unit& unit, WorkerContext& worker) override {
    if (context_->lock != nullptr) context_->lock->check();
    if (is_node(unit.key))
      encode_level(*context_, job_, *levels_, unit.key - first_node(), worker);
    else if (is_merged(unit.key))
      encode_merged(*context_, job_, plan_, merged_.parts, worker);
    else
      encode_unit(*context_, job_, plan_, unit.key, worker);
  }
  void close(RunContext& context) override;

 private:
  Listing listing(const InterruptFlag* interrupt) const;
  bool is_merged(std::uint64_t unit) const { return merged_.write && unit == plan_.size(); }
  std::uint64_t first_node() const { return plan_.size() + (merged_.write ? 1 : 0); }
  bool is_node(std::uint64_t unit) const { return unit >= first_node(); }
  // With half as many polygons as triangles.
  PlannedTile largest(std::uint64_t unit) const {
    return is_node(unit) ? levels_->size(unit - first_node()) : plan_.largest(unit);
  }
  std::uint64_t pair_bytes(std::uint64_t pairs) const {
    return pairs * costliest_of_pairs(job_).pair_bytes;
  }
  // Of a coarse tile at most.
  std::uint64_t pairs_in(std::uint64_t unit) const {
    if (is_node(unit) && plan_.of_labels()) return levels_->labels(unit - first_node());
    if (pairs_.empty()) return 0;
    return is_node(unit) ? sum(pairs_) : pairs_[unit];
  }

  const Config& config_;
  const EncodeJob& job_;
  const Hash128 planned_;
  const UnitPlan& plan_;
  const LevelMeshes* const levels_;
  const std::function<Manifest()> manifest_;
  const std::vector<std::uint64_t> pairs_;  // of labels, in each tile
  const MergedPlan merged_;
  const RunContext* context_ = nullptr;
};

std::vector<Unit> EncodeStage::units(std::span<const std::uint64_t> numbers) const {
  std::vector<Unit> units;
  double polygons = 0;
  for (std::uint64_t unit = 0; unit < plan_.size() && merged_.write; ++unit)
    polygons += static_cast<double>(plan_.total(unit).polygons);
  for (const std::uint64_t number : numbers)
    if (is_merged(number))
      units.push_back({number, "merged mesh", plan_.size() > 1 ? polygons : 0, 0, true});
    else if (is_node(number))
      units.push_back({number,
                       "tile of level " + levels_->tree().nodes()[number - first_node()].name(),
                       static_cast<double>(largest(number).polygons)});
    else
      units.push_back(
          {number, plan_.name(number), static_cast<double>(plan_.total(number).polygons)});
  return units;
}

StageLook EncodeStage::look(const UnitSelection& selection) {
  StageLook look = StageWork::look(selection);
  if (selection.all() && !output_is_finished(job_.output))
    look.rest = "the manifest or the list of tiles is missing";
  return look;
}

std::string EncodeStage::missing_text(const StageLook& look) const {
  if (look.missing.empty()) return look.rest;
  const bool merged =
      merged_.write && std::ranges::binary_search(look.missing, std::uint64_t{plan_.size()});
  return fmt::format("{} of {} tiles{} missing", look.missing.size() - (merged ? 1 : 0),
                     size() - (merged_.write ? 1 : 0), merged ? " and the merged mesh" : "");
}

std::uint64_t EncodeStage::bytes(std::uint64_t unit) {
  if (is_merged(unit)) return plan_.size() > 1 ? merged_.bytes : all_memory;
  const std::uint64_t pairs = pairs_in(unit);
  return encode_bytes(config_, largest(unit), pairs > 0) + pair_bytes(pairs);
}

StageMemory EncodeStage::memory(std::span<const std::uint64_t> numbers) {
  std::uint64_t need = 0, pairs = 0;
  for (const std::uint64_t number : numbers) {
    if (is_merged(number)) continue;  // planned to fit
    need = std::max(need, bytes(number));
    pairs = std::max(pairs, pairs_in(number));
  }
  StageMemory memory = encode_memory(config_, need);
  // The tree, and what is listed of each of its leaves.
  if (levels_ != nullptr && plan_.of_labels())
    memory.base_bytes = levels_->tree().bytes() + levels_->tree().leaves().size() * listed_bytes;
  if (pairs > 0) memory.unit += fmt::format(" with {} pairs of labels", pairs);
  if (pairs > 0 && job_.formats.size() > 1) {
    const MeshWriter& costliest = costliest_of_pairs(job_);
    memory.advice = fmt::format(
        "raise run.memory, lower output.tile_vertices, or leave \"{}\", which takes {} for each "
        "pair, out of output.formats; what is finished is kept",
        costliest.name, readable_bytes(static_cast<double>(costliest.pair_bytes)));
  }
  return memory;
}

void EncodeStage::check(const RunContext& context, const StageLook& look) const {
  if (context.force || look.missing.empty()) return;
  check_owner(job_.output, context.config_file);
  if (look.missing.size() == context.selection.count(look.units)) check_strangers(job_);
}

void EncodeStage::open(RunContext& context, const StageLook& look) {
  if (!merged_.why_not.empty())
    spdlog::warn("no merged mesh{}: {}; {}", merged_.write ? " in some formats" : "",
                 merged_.why_not, what_there_is(merged_, job_));
  if (look.missing.empty()) return;
  const Hash128 key = planned_key(job_, planned_, merged_.write, size() - first_node());
  if (has_begun(job_.output, key)) return;
  check(context, look);
  FileNames names(job_.folder);
  begin_output(job_.output, {key, context.config_file.string()}, names, [&](FileNames& all) {
    each_planned(job_, plan_, levels_, merged_, [&](const std::string& name) { all.add(name); });
  });
}

void EncodeStage::close(RunContext& context) {
  if (context.interrupt != nullptr) context.interrupt->check();
  if (context.lock != nullptr) context.lock->check();
  Manifest manifest = manifest_();
  manifest.stages = std::make_unique<nlohmann::json>(stages_json(context));
  FileNames earlier(job_.folder);
  add_files_of_earlier_runs(job_.output, earlier);
  write_listing(listing(context.interrupt), earlier, std::move(manifest));
}

Listing EncodeStage::listing(const InterruptFlag* interrupt) const {
  Listing listing;
  listing.interrupt = interrupt;
  for (std::uint64_t unit = 0; unit < plan_.size(); ++unit)
    listing.tiles.push_back({plan_.largest(unit).key(), asset_record_path(job_, plan_, unit)});
  if (merged_.write) listing.merged = merged_record_path(job_);
  listing.labels = label_mode(job_);
  listing.normals = config_.output.normals;
  listing.materials = job_.materials;
  listing.output = job_.output;
  listing.scratch = job_.folder;
  if (levels_ != nullptr && plan_.of_labels())
    listing.place = [this](std::size_t unit, std::size_t mesh) -> std::optional<CellKey> {
      const LevelLeaf& leaf = levels_->tree().leaves()[plan_.first_tile(unit) + mesh];
      return leaf.whole ? std::optional(leaf.place) : std::nullopt;
    };
  if (levels_ != nullptr)
    listing.levels = [this, tiles = listing](Manifest& out, FileNames& leftovers) {
      list_levels({job_, *levels_, tiles}, out, leftovers);
    };
  return listing;
}

}  // namespace

std::uint64_t encode_bytes(const Config& config, const PlannedTile& tile, bool of_pairs) {
  const std::uint64_t v = vertices_with_border(tile), t = 2 * tile.polygons;
  return stitch_bytes(v, tile.polygons) / 2 +
         encode_memory_bytes(v, t, config.output.normals,
                             of_pairs || config.labels.mode == LabelMode::shared);
}

StageMemory encode_memory(const Config& config, std::uint64_t largest) {
  return {"encode", 0, largest,
          fmt::format("one tile (output.tile_vertices = {})", config.output.tile_vertices),
          "raise run.memory or lower output.tile_vertices; what is finished is kept"};
}

MergedPlan plan_merged(const Config& config, const UnitPlan& units, std::uint64_t pair_bytes) {
  MergedPlan plan;
  if (units.of_labels() || config.output.merged == OutputConfig::Merged::never) return plan;
  const MergedSizes sizes = merged_sizes(config, units);
  const auto formats = writers_named(mesh_writers(), config.output.formats);
  const std::uint64_t program = program_bytes(), most = config.run.memory;
  const bool any_streamed = std::ranges::any_of(formats, &MeshWriter::is_streamed);
  const bool any_whole = !std::ranges::all_of(formats, &MeshWriter::is_streamed);
  const bool streams = any_streamed && program + sizes.streamed <= most;
  const bool whole = any_whole && program + sizes.whole + pair_bytes <= most;
  plan.write = streams || (whole && !any_streamed);
  plan.parts = any_whole && !whole ? MergedParts::streamed : MergedParts::all;
  plan.bytes = std::max(whole ? sizes.whole + pair_bytes : 0, streams ? sizes.streamed : 0);
  if (whole == any_whole && streams == any_streamed) return plan;
  const std::uint64_t needed =
      program + (whole == any_whole ? sizes.streamed : sizes.whole + pair_bytes);
  const std::string figures =
      fmt::format("one mesh of {} triangles takes {} to {}, run.memory is {}", sizes.triangles,
                  readable_bytes(static_cast<double>(needed)),
                  whole == any_whole ? "write" : "encode", exact_bytes(most));
  if (config.output.merged == OutputConfig::Merged::always)
    throw InputError("output.merged = true: " + figures +
                     "; raise run.memory, or leave output.merged = \"auto\" and use the tiles");
  plan.why_not = figures;
  return plan;
}

std::unique_ptr<StageWork> encode_stage(EncodeInputs inputs) {
  return std::make_unique<EncodeStage>(std::move(inputs));
}

}  // namespace voxweld
