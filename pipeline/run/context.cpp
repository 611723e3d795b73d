#include "pipeline/run/context.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <utility>

#include "pipeline/config/edits.h"
#include "pipeline/config/settings.h"
#include "pipeline/labels/label_rules.h"
#include "pipeline/run/encode_stage.h"
#include "pipeline/solids/edit_meshes.h"
#include "pipeline/solids/mesh_input.h"
#include "stages/build/label_edge.h"
#include "storage/artifact/label_shard_artifact.h"
#include "storage/artifact/label_top.h"
#include "storage/artifact/shard_artifact.h"
#include "storage/artifact/tile_artifact.h"
#include "storage/artifact/top_artifact.h"

namespace voxweld {

std::uint64_t program_bytes() {
  constexpr std::uint64_t least = std::uint64_t{40} << 20, slack = std::uint64_t{16} << 20;
  return std::max(least, resident_bytes() + slack);
}

int stage_threads(const RunContext& context, StageMemory memory) {
  memory.base_bytes += program_bytes();
  return threads_within(context.budget(), memory, context.threads);
}

void run_stage(RunContext& context, const StageRun& stage, const std::vector<Unit>& units,
               int threads, const UnitWork& work) {
  release_free_memory();
  const StageMeter meter;
  StageStart start{stage.stage, stage.noun, units.size(), 0, stage.reused};
  for (const Unit& unit : units) start.weight += unit.weight;
  StageProgress progress(context.console, context.progress, start);
  StageFigures elsewhere;
  const RunOptions options{threads,    stage.order,    &progress, context.interrupt,
                           stage.done, stage.identity, &elsewhere};
  context.executor->run_units(stage.stage, units, work, options);
  StageFigures figures = meter.read();
  if (!context.executor->in_process()) {
    figures.cpu_s = elsewhere.cpu_s;
    figures.peak_resident = elsewhere.peak_resident;
  }
  progress.finish(figures);
  context.reports.push_back({stage.stage, units.size() + stage.reused, units.size(), figures});
}

double smallest_spacing(const VolumeGeometry& geometry) {
  return std::min({geometry.spacing.x, geometry.spacing.y, geometry.spacing.z});
}

namespace {

// The config's edits are in output coordinates; a mesh as input comes before them.
Edits make_edits(const Config& config, const SampleSource& source) {
  const VolumeGeometry& geometry = source.info().geometry;
  Edits edits = edits_of(config);
  for (Edit& edit : edits) edit.solid.center = edit.solid.center - geometry.first;
  load_edit_meshes(config, geometry, edits);
  const auto* mesh = dynamic_cast<const MeshVolume*>(&source);
  if (mesh == nullptr) return edits;
  warn_of_cut_edits(geometry, edits);
  edits.insert(edits.begin(), {EditOp::add, mesh->solid()});
  return edits;
}

}  // namespace

ContourParameters contour_parameters(const Config& config, const SampleSource& source,
                                     LabelParameters labels) {
  const VolumeGeometry& geometry = source.info().geometry;
  // The enumerators of both come in the order of the settings' table.
  ContourParameters p;
  p.spacing = geometry.spacing;
  p.surface.label = config.surface.label;
  p.surface.isovalue = config.surface.isovalue.value();
  p.surface.inside =
      config.surface.inside == SurfaceConfig::Inside::above ? Inside::above : Inside::below;
  p.surface.border =
      config.surface.border == SurfaceConfig::Border::closed ? Border::closed : Border::open;
  p.surface.gradient =
      config.surface.gradient == SurfaceConfig::Gradient::eno ? Gradient::eno : Gradient::central;
  p.labels = std::move(labels);
  const SimplifyConfig& s = config.simplify;
  p.simplify.enabled = s.enabled;
  p.simplify.tolerance =
      s.tolerance *
      (s.tolerance_unit == SimplifyConfig::Unit::voxel ? smallest_spacing(geometry) : 1.0);
  p.simplify.metric = s.metric == SimplifyConfig::Metric::rms ? Metric::rms : Metric::sum;
  p.simplify.topology =
      s.topology == SimplifyConfig::Topology::safe ? Topology::safe : Topology::free;
  p.simplify.qef = s.qef == SimplifyConfig::Qef::qr ? QefForm::qr : QefForm::normal;
  p.edits = make_edits(config, source);
  return p;
}

BrickGrid brick_grid(const Config& config, const VolumeGeometry& geometry) {
  return BrickGrid(geometry.size, std::countr_zero(static_cast<std::uint64_t>(config.work.brick)),
                   static_cast<int>(config.work.shard));
}

std::string short_hex(Hash128 hash) {
  return to_hex(hash).substr(0, 12);
}

VolumeGeometry output_geometry(const VolumeGeometry& geometry, const OutputLattice& lattice) {
  VolumeGeometry output = geometry;
  if (moved(lattice, geometry.first).fits_floats()) return output;
  output.origin = geometry.first;
  output.first = {};
  return output;
}

StagePaths stage_paths(const Config& config, const VolumeInfo& info,
                       const LabelParameters& labels) {
  const VolumeGeometry& g = info.geometry;
  const auto vec = [](KeyHasher& key, Vec3 v) { key.real(v.x).real(v.y).real(v.z); };
  StagePaths paths;
  const std::filesystem::path& work = config.work.directory;
  KeyHasher ingest;
  ingest.hash(parameter_hash(config, Stage::ingest)).text(config.input.path.string());
  paths.ingest = work / ("ingest-" + short_hex(ingest.finish()));

  KeyHasher build;
  const bool each = config.labels.mode == LabelMode::each;
  build.text("build").integer(shard_version).hash(parameter_hash(config, Stage::build));
  if (each) build.integer(label_shard_version);
  build.text(sample_type_name(info.type));
  build.integer(g.size.x).integer(g.size.y).integer(g.size.z);
  vec(build, g.spacing);
  if (each || labels.mode != LabelMode::off || config.surface.label)
    build.integer(label_estimate_version);
  if (labels.mode != LabelMode::off) build.hash(hash_of(*labels.rules));
  paths.build_key = build.finish();
  paths.build = work / ("build-" + short_hex(paths.build_key));

  const auto next = [&](Stage stage, std::uint32_t version, Hash128 before) {
    KeyHasher key;
    key.text(stage_name(stage)).integer(version).hash(before).hash(parameter_hash(config, stage));
    return key.finish();
  };
  const std::uint32_t of_labels = each ? label_top_version << 16 : 0;
  paths.merge_key = next(Stage::merge, top_version | of_labels, paths.build_key);
  paths.merge = work / ("merge-" + short_hex(paths.merge_key));
  paths.stitch_key = next(Stage::stitch, tile_version, paths.merge_key);
  if (g.first != Vec3{}) {
    KeyHasher stitch;
    stitch.hash(paths.stitch_key).text("first");
    vec(stitch, g.first);
    paths.stitch_key = stitch.finish();
  }
  paths.stitch = work / ("stitch-" + short_hex(paths.stitch_key));
  KeyHasher encode;
  encode.hash(next(Stage::encode, encode_version, paths.stitch_key));
  vec(encode, g.origin);
  for (const Vec3& axis : g.direction) vec(encode, axis);
  encode.text(g.unit);
  paths.encode_key = encode.finish();
  paths.encode = work / ("encode-" + short_hex(paths.encode_key));
  return paths;
}

std::filesystem::path fanned_out(const std::filesystem::path& root, Index3 at,
                                 const std::string& name) {
  // At most 16 x 16 x 16 / 16 files a folder of the last level: folders by z and by (y, x) / 16.
  return root / fmt::format("{:03x}", at.z) / fmt::format("{:02x}{:02x}", at.y / 16, at.x / 16) /
         name;
}

}  // namespace voxweld
