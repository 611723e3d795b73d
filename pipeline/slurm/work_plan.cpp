#include "pipeline/slurm/work_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "pipeline/ingest/spooled_input.h"
#include "pipeline/slurm/batch_script.h"
#include "pipeline/slurm/queued_tasks.h"
#include "pipeline/slurm/task_cost.h"
#include "pipeline/slurm/task_plan.h"
#include "storage/manifest/task_report.h"
#include "storage/spool/spool.h"

namespace voxweld {
namespace {

constexpr std::int64_t bricks_to_look_at = 125;

// Of ordinary scans at the default settings, a brick of 64^3 cells: what a look at the volume's own
// bricks replaces.
constexpr BrickSample usual{1, 1, 2500, 2800, 150'000, 0.008, {}};

// Of reading an input and counting its labels, against copying it.
constexpr double counting_cost = 0.25;

// Bytes a vertex: a tile artifact, and one asset with its normals.
constexpr double tile_bytes = 62, asset_bytes = 6;
// And of a mesh sorted by cubes, where vertices at borders are in several parts.
constexpr double cubes_bytes = 75;
// What a unit of survey leaves.
constexpr double counts_bytes = 1200;
// The tiles of a plan are cubes of the octree, so most hold much less than they may.
constexpr double tile_filling = 0.35;

double usual_cost(const char* stage, double weight) {
  return usual_seconds_per_weight(stage) * weight;
}

std::uint64_t product(Index3 v) {
  return static_cast<std::uint64_t>(v.x) * static_cast<std::uint64_t>(v.y) *
         static_cast<std::uint64_t>(v.z);
}

std::uint64_t count_tasks(std::uint64_t units, double cpu_s, const Config& config,
                          std::int64_t slots) {
  return count_even_tasks(units, cpu_s, task_plan_request(config, slots, 1));
}

void add_used(const Config& config, WorkPlan& plan) {
  for (const KnownArray& array : known_arrays(config)) {
    const std::size_t tasks = array.folder.tasks().size();
    for (std::size_t t = 0; t < tasks; ++t) {
      const auto report = read_task_report(array.folder.report_path(static_cast<std::int64_t>(t)));
      if (!report) continue;
      ++plan.tasks_reported;
      for (PlannedStage& stage : plan.stages)
        if (report->stage == stage_name(stage.stage)) {
          stage.used_cpu_s += report->cpu_s;
          stage.used_peak_bytes = std::max(stage.used_peak_bytes, report->peak_resident);
        }
    }
  }
}

// Of a mesh as the input that is cut up: what its bins take of each triangle.
constexpr double bin_bytes = 85, cut_s = 1.5e-6;

double rounded_up(double value) {
  return std::max(1.0, std::ceil(value));
}

// Of the samples, what lies in spools at once.
double spooled_share(const Config& config, const VolumeInfo& info) {
  const std::int64_t slices = info.geometry.size.z;
  const std::int64_t height = spool_height(info, config.work.brick * config.work.shard);
  return static_cast<double>(std::min(height, slices)) / static_cast<double>(slices);
}

}  // namespace

WorkPlan plan_work(const RunContext& context, const Jobs& jobs, std::int64_t slots) {
  const Config& config = context.config;
  const VolumeInfo& info = jobs.ingest().info;
  const BrickGrid grid = brick_grid(config, info.geometry);
  WorkPlan plan;
  plan.bricks = product(sampled_bricks(grid));
  plan.sample = sample_bricks(context, jobs, bricks_to_look_at);
  plan.task_bytes = task_memory(config);
  plan.task_cpus = config.slurm.cpus_per_task;
  const BrickSample look = plan.sample.value_or(usual);
  const double side = static_cast<double>(config.work.brick);
  // Cells that the usual figures' bricks would be.
  const double scale = static_cast<double>(plan.bricks) / static_cast<double>(look.bricks) *
                       (plan.sample ? 1.0 : side * side * side / (64.0 * 64 * 64));
  const auto whole = [&](auto value) { return static_cast<double>(value) * scale; };
  plan.vertices = whole(look.vertices);
  const double polygons = whole(look.polygons);
  const std::uint64_t shards =
      product(grid.shards());  // counted, not listed: there may be billions
  const auto samples = static_cast<double>(product(info.geometry.size));
  const auto bytes = [](double value) { return static_cast<std::uint64_t>(value); };

  const auto add = [&](Stage stage, double units, double files, double disk, double cpu_s) {
    PlannedStage entry{stage, bytes(units), 0, bytes(files), bytes(disk), cpu_s, 0, 0};
    entry.tasks = count_tasks(entry.units, cpu_s, config, slots);
    plan.stages.push_back(entry);
  };
  const auto n = static_cast<double>(shards);
  if (const auto& mesh = jobs.ingest().mesh) {
    const auto triangles = static_cast<double>(mesh->record.triangles);
    add(Stage::ingest, 1, rounded_up(n / 4) + 1, bin_bytes * triangles, cut_s * triangles);
  }
  if (jobs.ingest().by_shards()) {
    const bool copy = jobs.ingest().copy;
    const double size = samples * static_cast<double>(sample_bytes(info.type));
    const double files = (copy ? 2 * n + 1 : 0) + (jobs.ingest().labels ? n + 1 : 0);
    add(Stage::ingest, n, files, copy ? size : 0,
        usual_cost("ingest", samples) * (copy ? 1 : counting_cost));
    if (copy && info.access != Access::box)
      plan.spool_bytes = bytes(size * spooled_share(config, info));
  }
  add(Stage::build, n, n, whole(look.octree_bytes), whole(look.cpu_s) * 1.3);  // and reading
  add(Stage::merge, 1, 1, 16 * n, 1e-4 * n);
  const auto tiles_of = [&](std::int64_t vertices) {
    return rounded_up(plan.vertices / (static_cast<double>(vertices) * tile_filling));
  };
  const double planned = tiles_of(planned_tile_vertices(config));
  const double tiles = tiles_of(config.output.tile_vertices);
  add(Stage::stitch, planned, planned, tile_bytes * plan.vertices,
      usual_cost("stitch", plan.vertices + polygons));
  if (refines(config)) {
    for (const Stage pass : stages_of(config)) {
      const double weight = plan.vertices + polygons;
      if (pass == Stage::survey || pass == Stage::recount)
        add(pass, planned, planned, counts_bytes * planned, usual_cost("survey", weight));
      if (Stage::refine <= pass && pass <= Stage::remend && pass != Stage::recount) {
        // Where the mesh is only repaired, the first one looks and writes nothing.
        const bool looks = pass == Stage::refine && only_repairs(config);
        const bool only_mends = pass >= Stage::mend || only_repairs(config);
        add(pass, planned, planned, looks ? 0 : cubes_bytes * plan.vertices,
            usual_cost(only_mends ? "mend" : "refine", weight));
      }
    }
    add(Stage::retile, tiles, tiles + 1, tile_bytes * plan.vertices,
        usual_cost("retile", polygons));
    // Each level has a quarter of the one before, and takes what collapsing that one takes.
    if (has_levels(config))
      add(Stage::levels, rounded_up(tiles / 3), rounded_up(tiles / 3),
          cubes_bytes * plan.vertices / 3, usual_cost("refine", plan.vertices + polygons) * 4 / 3);
  }
  const auto formats = static_cast<double>(config.output.formats.size());
  add(Stage::encode, tiles, tiles * (formats + 1) + 2, asset_bytes * formats * plan.vertices,
      usual_cost("encode", polygons));
  add_used(config, plan);
  return plan;
}

std::string to_text(const WorkPlan& plan) {
  std::string text;
  if (plan.sample)
    text += fmt::format(
        "Estimated from {} of {} bricks ({}{:.0f} % with a surface) and rates measured "
        "elsewhere:\n",
        plan.sample->bricks, plan.bricks,
        plan.sample->isovalue ? fmt::format("isovalue {}, ", isovalue_text(*plan.sample->isovalue))
                              : "",
        100.0 * static_cast<double>(plan.sample->active) /
            static_cast<double>(plan.sample->bricks));
  else
    text += fmt::format(
        "Estimated from the size alone ({} bricks) and rates of ordinary scans: the input is not "
        "read by boxes, so none of it was looked at:\n",
        plan.bricks);
  text += fmt::format("{:<7} {:>9} {:>7} {:>9} {:>11} {:>11} {:>11} {:>11}\n", "stage", "units",
                      "tasks", "files", "disk", "core-hours", "used", "peak");
  PlannedStage total;
  const auto row = [&](const std::string& name, const PlannedStage& stage) {
    text += fmt::format(
        "{:<7} {:>9} {:>7} {:>9} {:>11} {:>11.2g} {:>11} {:>11}\n", name, stage.units, stage.tasks,
        stage.files, readable_bytes(static_cast<double>(stage.disk_bytes)), stage.cpu_s / 3600,
        stage.used_cpu_s > 0 ? fmt::format("{:.2g}", stage.used_cpu_s / 3600) : "-",
        stage.used_peak_bytes > 0 ? readable_bytes(static_cast<double>(stage.used_peak_bytes))
                                  : "-");
  };
  for (const PlannedStage& stage : plan.stages) {
    row(std::string(stage_name(stage.stage)), stage);
    total.units += stage.units;
    total.tasks += stage.tasks;
    total.files += stage.files;
    total.disk_bytes += stage.disk_bytes;
    total.cpu_s += stage.cpu_s;
    total.used_cpu_s += stage.used_cpu_s;
    total.used_peak_bytes = std::max(total.used_peak_bytes, stage.used_peak_bytes);
  }
  row("all", total);
  if (plan.spool_bytes > 0)
    text += fmt::format("while ingest runs also {} for the slices of each layer being read\n",
                        readable_bytes(static_cast<double>(plan.spool_bytes)));
  text += fmt::format("a task: {} processors, {} of memory; about {:.3g} vertices in all\n",
                      plan.task_cpus, readable_bytes(static_cast<double>(plan.task_bytes)),
                      plan.vertices);
  return text;
}

nlohmann::json to_json(const WorkPlan& plan) {
  nlohmann::json out = {{"bricks", plan.bricks},
                        {"vertices", plan.vertices},
                        {"spool_bytes", plan.spool_bytes},
                        {"task_bytes", plan.task_bytes},
                        {"task_cpus", plan.task_cpus},
                        {"tasks_reported", plan.tasks_reported},
                        {"stages", nlohmann::json::array()}};
  out["bricks_looked_at"] = plan.sample ? plan.sample->bricks : 0;
  for (const PlannedStage& stage : plan.stages)
    out["stages"].push_back({{"stage", stage_name(stage.stage)},
                             {"units", stage.units},
                             {"tasks", stage.tasks},
                             {"files", stage.files},
                             {"disk_bytes", stage.disk_bytes},
                             {"cpu_seconds", stage.cpu_s},
                             {"used_cpu_seconds", stage.used_cpu_s},
                             {"used_peak_bytes", stage.used_peak_bytes}});
  return out;
}

}  // namespace voxweld
