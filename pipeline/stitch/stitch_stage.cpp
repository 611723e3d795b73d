#include "pipeline/stitch/stitch_stage.h"

#include <fmt/format.h>

#include <algorithm>

#include "pipeline/executor/probe.h"
#include "pipeline/stitch/stitch_work.h"
#include "storage/artifact/tile_artifact.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

// What it would be made from is looked up only where there is something to compare it with.
bool is_current(const std::filesystem::path& path, StitchWork& work, std::uint64_t unit) {
  if (!std::filesystem::exists(path)) return false;
  try {
    return TileArtifact(path).key() == work.key(unit);
  } catch (const DamagedArtifact& damage) {
    if (damage.path() != path.string()) throw;
    return false;
  }
}

// The most bytes that stitching one of these units takes.
std::uint64_t largest_unit_bytes(const UnitPlan& plan, const std::vector<std::uint64_t>& numbers,
                                 StitchWork& work) {
  std::vector<std::uint64_t> need(numbers.size());
  probe_all(numbers.size(), [&](std::size_t i) {
    const PlannedTile tile = plan.largest(numbers[i]);
    need[i] = stitch_bytes(tile.vertices + tile.vertices / 4, tile.polygons) +
              work.brick_bytes(numbers[i]);
  });
  return need.empty() ? 0 : *std::max_element(need.begin(), need.end());
}

}  // namespace

std::vector<std::uint64_t> missing_tiles(const RunContext& context, const StitchJob& job,
                                         const TopArtifact& top) {
  const auto plan = unit_plan(top, job.build->parameters.labels.mode);
  const auto work = stitch_work(job, top);
  const auto missing = probe_which(plan->size(), [&](std::size_t i) {
    return context.selection.contains(i) &&
           !is_current(tile_artifact_path(job, *plan, i), *work, i);
  });
  return {missing.begin(), missing.end()};
}

void run_stitch(RunContext& context, const StitchJob& job) {
  const TopArtifact top(job.merge->path());
  const auto plan = unit_plan(top, job.build->parameters.labels.mode);
  context.selection.check("stitch", "tiles", plan->size());
  const std::vector<std::uint64_t> missing = missing_tiles(context, job, top);
  const auto work = stitch_work(job, top);
  std::vector<Unit> units;
  for (const std::uint64_t number : missing) {
    const PlannedTile total = plan->total(number);
    units.push_back(
        {number, plan->name(number), static_cast<double>(total.vertices + total.polygons)});
  }
  // Elsewhere each process looks at its own units.
  const std::uint64_t need =
      context.executor->in_process() ? largest_unit_bytes(*plan, missing, *work) : 0;
  StageRun stage;
  stage.stage = "stitch";
  stage.noun = job.build->parameters.labels.mode == LabelMode::each ? "batches" : "tiles";
  stage.reused = context.selection.count(plan->size()) - missing.size();
  stage.memory = {
      "stitch", 0, need,
      fmt::format("one tile (output.tile_vertices = {})", context.config.output.tile_vertices),
      "raise run.memory or lower output.tile_vertices"};
  const int threads = stage_threads(context, stage.memory);
  stage.identity = job.folder.filename().string();
  const auto path_of = [&](const Unit& unit) { return tile_artifact_path(job, *plan, unit.key); };
  stage.done = [&](const Unit& unit) { return is_current(path_of(unit), *work, unit.key); };
  std::vector<StitchScratch> scratch(static_cast<std::size_t>(threads));
  run_stage(context, stage, units, threads, [&](const Unit& unit, WorkerContext& worker) {
    work->run(unit.key, path_of(unit), scratch[static_cast<std::size_t>(worker.slot())], worker);
  });
}

}  // namespace voxweld
