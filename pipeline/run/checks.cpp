#include "pipeline/run/checks.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <span>

#include "pipeline/encode/encode_stage.h"
#include "pipeline/stage/artifacts.h"
#include "stages/solids/solid.h"
#include "stages/solids/volume_frame.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

std::string values_text(const ValueRange& range) {
  if (!range.empty && range.lo == range.hi)
    return fmt::format("all samples are {}", isovalue_text(range.lo));
  return range.empty ? "all samples are NaN, which counts as outside"
                     : fmt::format("the values run from {} to {}", isovalue_text(range.lo),
                                   isovalue_text(range.hi));
}

// What the messages are about: filters may have made other values of the file's.
std::string volume_text(const Config& config) {
  const std::string path = config.input.path.string();
  return config.filters.empty() ? path : path + ", filtered";
}

// Whether a range says that all samples are inside.
bool all_inside(const SurfaceConfig& surface, const ValueRange& range) {
  if (range.empty || range.any_nan) return false;
  const double isovalue = surface.isovalue->value;
  if (surface.label) return range.lo == range.hi && range.lo == isovalue;
  return surface.inside == SurfaceConfig::Inside::above ? range.lo >= isovalue
                                                        : range.hi <= isovalue;
}

// A mesh of nothing but the volume's own faces is seldom what was meant. Then the edges that cross
// the surface are those into the ring; other volumes may have as many, so the samples decide.
void warn_of_box(RunContext& context, Stages& stages) {
  const Config& config = context.config;
  const Jobs& jobs = stages.jobs();
  if (!config.input.has_samples() || !config.edits.empty() || config.labels.mode != LabelMode::off)
    return;
  const Index3 size = jobs.volume().geometry().size;
  const auto faces =
      static_cast<std::uint64_t>(2 * (size.x * size.y + size.y * size.z + size.z * size.x));
  if (stages.top().counts().crossing_edges != faces) return;
  // To read all samples is no task for a cluster; there they are copied, and their ranges known.
  if (jobs.volume().ranges() == nullptr && !context.executor->in_process()) return;
  const ValueRange range = whole_range(context, jobs.volume());
  if (!all_inside(config.surface, range)) return;
  const std::string mesh = config.surface.border == SurfaceConfig::Border::open
                               ? "with an open border nothing is left of the mesh"
                               : "the mesh is the box of the volume";
  if (config.surface.label)
    spdlog::warn("surface.label = {}: all samples of {} are of that value, so {}",
                 *config.surface.label, config.input.path.string(), mesh);
  else
    spdlog::warn(
        "surface.isovalue = {}: all samples of {} are {} it, so {}; {}: choose one between, or "
        "turn "
        "surface.inside around",
        isovalue_text(*config.surface.isovalue), config.input.path.string(),
        config.surface.inside == SurfaceConfig::Inside::above ? "at or above" : "at or below", mesh,
        values_text(range));
}

void check_surface(RunContext& context, Stages& stages) {
  if (stages.top().counts().crossing_edges != 0) return;
  const Jobs& jobs = stages.jobs();
  if (const std::size_t edits = context.config.edits.size(); edits > 0)
    throw InputError(fmt::format(
        "no surface: after the {} of the config all samples are on one side; leave out or change "
        "some of the [[edit]] tables",
        edits == 1 ? "one edit" : fmt::format("{} edits", edits)));
  if (context.config.input.is_mesh())
    throw InputError(fmt::format(
        "{}: no surface: no sample lies inside the mesh; raise input.resolution or lower "
        "input.cell, which is {:g} now",
        context.config.input.path.string(), jobs.volume().geometry().spacing.x));
  const ValueRange range = whole_range(context, jobs.volume());
  if (context.config.labels.mode != LabelMode::off)
    throw InputError(fmt::format(
        "labels.mode: no surface: no sample of {} is of a label that is not left out; {}",
        context.config.input.path.string(), values_text(range)));
  if (const auto& label = context.config.surface.label)
    throw InputError(fmt::format(
        "surface.label = {}: no sample of {} is of that value; they run from {} to {}", *label,
        context.config.input.path.string(), isovalue_text(range.lo), isovalue_text(range.hi)));
  throw InputError(fmt::format(
      "surface.isovalue = {}: no surface: no sample is {} it. {}: {}{}",
      isovalue_text(*context.config.surface.isovalue),
      context.config.surface.inside == SurfaceConfig::Inside::above ? "at or above" : "at or below",
      volume_text(context.config), values_text(range),
      range.empty || range.lo == range.hi ? "" : "; choose one between"));
}

// A directory that cannot be written is better found now than after hours of work. Nothing is made
// yet: where there is no surface nothing shall be left.
void check_writable(const std::filesystem::path& directory, const std::string& key) {
  std::filesystem::path there = directory;
  std::error_code error;
  while (!std::filesystem::exists(there, error) && there.has_relative_path())
    there = there.parent_path();
  const bool folder = std::filesystem::is_directory(there, error);
  if (folder && access(there.c_str(), W_OK | X_OK) == 0) return;
  throw InputError(fmt::format("{} = \"{}\": cannot be written: {}; choose another directory", key,
                               directory.string(),
                               folder ? fmt::format("{}: {}", there.string(), std::strerror(errno))
                                      : fmt::format("{} is not a directory", there.string())));
}

// How large tiles are is the volume's to say, and output.tile_vertices only bounds it: once they
// are planned, a run.memory that is too small for one of them is refused before any is made.
void check_plan(RunContext& context, Stages& stages, Stage stage) {
  // What refine leaves of the mesh is known before encode.
  const bool last = stage == Stage::encode || !refines(context.config);
  const UnitPlan& plan = last ? stages.plan() : stages.merged_plan();
  std::uint64_t largest = 0;
  for (std::uint64_t unit = 0; unit < plan.size(); ++unit)
    largest = std::max(largest, encode_bytes(context.config, plan.largest(unit)));
  stage_threads(context, encode_memory(context.config, largest));
  if (last) plan_merged(context.config, plan);
}

// As an edit's messages name a place: spacing * sample index.
std::string place_of(Vec3 p) {
  return fmt::format("[{:g}, {:g}, {:g}]", p.x, p.y, p.z);
}

}  // namespace

void check_directories(const Config& config) {
  check_writable(config.work.directory, "work.directory");
  check_writable(config.output.directory, "output.directory");
}

void check_before(RunContext& context, Stages& stages, Stage stage) {
  if (stage != Stage::stitch && stage != Stage::encode) return;
  check_surface(context, stages);
  if (stage == Stage::stitch && context.selection.all()) warn_of_box(context, stages);
  check_plan(context, stages, stage);
}

void check_work(const RunContext& context, StageWork& work, const StageLook& look) {
  work.check(context, look);
  const std::vector<std::uint64_t> units = look.to_do();
  // A cluster's tasks have the memory of their own machines.
  if (!units.empty() && context.config.run.executor == RunConfig::Executor::local)
    stage_threads(context, work.memory(units));
}

void warn_of_idle_edits(Stages& stages) {
  stages.open(Stage::build);
  const BuildJob& job = stages.jobs().build();
  const VolumeGeometry& geometry = job.volume.geometry();
  const VolumeFrame frame{geometry.size, geometry.spacing};
  const Bounds samples{{}, frame.place_of_sample(geometry.size - splat(1))};
  // A mesh that is the input comes before those of the config.
  const std::span<const Edit> edits =
      std::span(job.parameters.edits).subspan(job.volume.solid ? 1 : 0);
  for (std::size_t i = 0; i < edits.size(); ++i) {
    const Edit& edit = edits[i];
    if (edit_reaches(edit, samples)) continue;
    spdlog::warn(
        "edit {} changes nothing: {} the volume, whose samples run from {} to {}; correct its "
        "place or size, or remove it",
        i + 1, edit.op == EditOp::intersect ? "it holds all of" : "it lies outside",
        place_of(geometry.first + samples.lo), place_of(geometry.first + samples.hi));
  }
}

}  // namespace voxweld
