#include "pipeline/stage/artifacts.h"

#include <fmt/format.h>

#include "pipeline/config/settings.h"
#include "pipeline/stage/file_layout.h"
#include "stages/build/build_brick.h"
#include "stages/build/label_edge.h"
#include "stages/solids/lattice_solid.h"
#include "storage/artifact/brick_ranges_artifact.h"
#include "storage/artifact/collapse_survey_artifact.h"
#include "storage/artifact/cube_mesh_artifact.h"
#include "storage/artifact/label_counts.h"
#include "storage/artifact/shard_artifact.h"
#include "storage/artifact/tile_artifact.h"
#include "storage/artifact/tile_plan_artifact.h"
#include "storage/artifact/top_artifact.h"

namespace voxweld {
namespace {

void feed(KeyHasher& key, Vec3 v) {
  for (int a = 0; a < 3; ++a) key.real(v[a]);
}

void feed(KeyHasher& key, const Edit& edit) {
  const Solid& solid = edit.solid;
  key.integer(static_cast<std::int64_t>(edit.op)).integer(static_cast<std::int64_t>(solid.shape));
  if (edit.material != exterior) key.integer(static_cast<std::int64_t>(edit.material));
  feed(key, solid.center);
  for (const Vec3& axis : solid.axes) feed(key, axis);
  feed(key, solid.size);
  key.real(solid.radius).real(solid.height).real(solid.tube);
  // What is in the file, not where it lies.
  if (solid.mesh != nullptr) key.real(solid.scale).hash(solid.mesh->source());
}

Hash128 key_within(const BuildJob& job, const Bounds& bounds) {
  KeyHasher key;
  bool any = false;
  for (const Edit& edit : job.parameters.edits) {
    if (!edit_reaches(edit, bounds)) continue;
    if (!any) key.hash(job.key).text("edits");
    any = true;
    feed(key, edit);
  }
  return any ? key.finish() : job.key;
}

Box3 halo(const BuildJob& job, Index3 brick) {
  return halo_samples(place_of_brick(job.grid, brick), job.parameters);
}

std::string grid_name(Index3 at, const char* ending) {
  return fmt::format("{}-{}-{}{}", at.x, at.y, at.z, ending);
}

}  // namespace

StagePaths stage_paths(const Config& config, const VolumeInfo& info, const LabelParameters& labels,
                       int cube_level) {
  const VolumeGeometry& g = info.geometry;
  const auto vec = [](KeyHasher& key, Vec3 v) { key.real(v.x).real(v.y).real(v.z); };
  StagePaths paths;
  const std::filesystem::path& work = config.work.directory;
  KeyHasher ingest;
  ingest.hash(parameter_hash(config, Stage::ingest)).text(config.input.path.string());
  paths.ingest = work / ("ingest-" + short_hex(ingest.finish()));

  KeyHasher build;
  build.text("build").integer(shard_version).hash(parameter_hash(config, Stage::build));
  build.text(sample_type_name(info.type));
  build.integer(g.size.x).integer(g.size.y).integer(g.size.z);
  vec(build, g.spacing);
  // Without it keys are those of before there were any.
  if (!info.scale.identity()) build.text("scale").real(info.scale.slope).real(info.scale.intercept);
  if (config.surface.noise) build.text("noise").real(*config.surface.noise);
  if (const double overhang = vertex_overhang(config); overhang != 0)
    build.text("overhang").real(overhang);
  if (labels.rules != nullptr || config.surface.label) build.integer(label_estimate_version);
  if (labels.rules != nullptr) build.hash(hash_of(*labels.rules));
  paths.build_key = build.finish();
  paths.build = work / ("build-" + short_hex(paths.build_key));

  const auto next_of = [](const Config& of, Stage stage, std::uint32_t version, Hash128 before) {
    KeyHasher key;
    key.text(stage_name(stage)).integer(version).hash(before).hash(parameter_hash(of, stage));
    return key.finish();
  };
  const auto next = [&](Stage stage, std::uint32_t version, Hash128 before) {
    return next_of(config, stage, version, before);
  };
  paths.merge_key = [&] {
    Config planned = config;
    planned.output.tile_vertices = planned_tile_vertices(config);
    return next_of(planned, Stage::merge, top_version, paths.build_key);
  }();
  paths.merge = work / ("merge-" + short_hex(paths.merge_key));
  paths.stitch_key = next(Stage::stitch, stitch_version << 16 | tile_version, paths.merge_key);
  if (g.first != Vec3{}) {
    KeyHasher stitch;
    stitch.hash(paths.stitch_key).text("first");
    vec(stitch, g.first);
    paths.stitch_key = stitch.finish();
  }
  Hash128 meshes = paths.stitch_key;
  if (refines(config)) {
    paths.stitch_key =
        KeyHasher().hash(paths.stitch_key).text("cubes").integer(cube_mesh_version).finish();
    if (cube_level != refine_cube_level)
      paths.stitch_key = KeyHasher().hash(paths.stitch_key).integer(cube_level).finish();
    constexpr std::uint32_t version = refine_version << 16 | cube_mesh_version;
    const Hash128 asked =
        KeyHasher().hash(paths.stitch_key).text(refine_name(refine_mode(config))).finish();
    paths.refine_key = next(Stage::refine, version, asked);
    paths.seams_key = next(Stage::seams, version, paths.refine_key);
    if (has_target(config)) {
      constexpr std::uint32_t counts = refine_version << 16 | collapse_survey_version;
      paths.survey_key = next(Stage::survey, counts, asked);
      paths.recount_key = next(Stage::recount, counts, paths.refine_key);
      paths.survey = work / ("survey-" + short_hex(paths.survey_key));
      paths.recount = work / ("recount-" + short_hex(paths.recount_key));
    }
    if (has_stage(config, Stage::seams))
      paths.seams = work / ("seams-" + short_hex(paths.seams_key));
    Hash128 last = paths.seams.empty() ? paths.refine_key : paths.seams_key;
    if (mends(config)) {
      paths.mend_key = next(Stage::mend, version, paths.seams_key);
      paths.mend = work / ("mend-" + short_hex(paths.mend_key));
      last = paths.remend_key = next(Stage::remend, version, paths.mend_key);
      paths.remend = work / ("remend-" + short_hex(paths.remend_key));
    }
    if (planned_tile_vertices(config) != config.output.tile_vertices)
      last = KeyHasher().hash(last).text("tiles").integer(config.output.tile_vertices).finish();
    paths.retile_key = next(Stage::retile, tile_plan_version << 16 | tile_version, last);
    paths.refine = work / ("refine-" + short_hex(paths.refine_key));
    paths.retile = work / ("retile-" + short_hex(paths.retile_key));
    meshes = paths.retile_key;
    if (has_levels(config)) {
      // What is asked for says which tiles there are, not what is in them.
      paths.levels_key = KeyHasher()
                             .hash(last)
                             .text(stage_name(Stage::levels))
                             .integer(levels_version << 16 | version)
                             .finish();
      paths.levels = work / ("levels-" + short_hex(paths.levels_key));
    }
  }
  paths.stitch = work / ("stitch-" + short_hex(paths.stitch_key));
  KeyHasher encode;
  encode.hash(next(Stage::encode, encode_version, meshes));
  vec(encode, g.origin);
  for (const Vec3& axis : g.direction) vec(encode, axis);
  encode.text(g.unit);
  paths.encode_key = encode.finish();
  paths.encode = work / ("encode-" + short_hex(paths.encode_key));
  return paths;
}

std::filesystem::path store_path(const std::filesystem::path& ingest) {
  return ingest / "volume.zarr";
}

std::filesystem::path store_records_path(const std::filesystem::path& ingest) {
  return ingest / "records";
}

std::filesystem::path histogram_path(const std::filesystem::path& ingest) {
  return ingest / "histogram";
}

std::filesystem::path label_counts_path(const std::filesystem::path& ingest) {
  return ingest / "labels.all";
}

std::filesystem::path label_counts_path(const std::filesystem::path& ingest, Index3 shard) {
  return fanned_out(ingest / "labels", shard, grid_name(shard, ".labels"));
}

Hash128 label_counts_key(Hash128 samples) {
  return KeyHasher().text("labels").integer(label_counts_version).hash(samples).finish();
}

std::filesystem::path shard_artifact_path(const BuildJob& job, Index3 shard) {
  return fanned_out(job.folder, shard, grid_name(shard, ".octree"));
}

ArtifactReader open_octrees(const BuildJob& job, Index3 shard) {
  return ArtifactReader(shard_artifact_path(job, shard), shard_kind, shard_version);
}

std::filesystem::path brick_ranges_path(const BuildJob& job, Index3 shard) {
  const std::int64_t side = std::int64_t{1} << job.grid.brick_level();
  return fanned_out(job.ranges, shard, grid_name(shard, fmt::format(".{}", side).c_str()));
}

Hash128 brick_ranges_key(const BuildJob& job) {
  KeyHasher key;
  key.text("ranges")
      .integer(brick_ranges_version)
      .text(sample_type_name(job.volume.source->info().type));
  key.integer(job.grid.brick_level()).integer(job.grid.shard_level());
  const Index3 size = job.grid.size();
  return key.integer(size.x).integer(size.y).integer(size.z).finish();
}

Hash128 shard_key(const BuildJob& job, Index3 shard) {
  return key_within(job, shard_bounds(job, shard));
}

Hash128 brick_key(const BuildJob& job, Index3 brick) {
  return key_within(job, brick_bounds(place_of_brick(job.grid, brick), job.parameters.spacing));
}

Box3 shard_samples(const BuildJob& job, Index3 shard) {
  const Box3 bricks = job.grid.shard_bricks(shard);
  const Box3 first = halo(job, bricks.lo), last = halo(job, bricks.hi - splat(1));
  return intersect({first.lo, last.hi}, Box3{{}, job.grid.size()});
}

Bounds shard_bounds(const BuildJob& job, Index3 shard) {
  const Box3 bricks = job.grid.shard_bricks(shard);
  const auto bounds = [&](Index3 brick) {
    return brick_bounds(place_of_brick(job.grid, brick), job.parameters.spacing);
  };
  return {bounds(bricks.lo).lo, bounds(bricks.hi - splat(1)).hi};
}

std::filesystem::path stitch_artifact_path(const StitchJob& job, const UnitPlan& plan,
                                           std::uint64_t unit) {
  return plan.path(job.folder, unit, job.cubes ? ".cubes" : ".tile");
}

std::filesystem::path refine_artifact_path(const RefineJob& job, const RefineUnit& unit) {
  const Index3 first = morton_decode(unit.range.cubes.begin);
  const bool counts = job.stage == Stage::survey || job.stage == Stage::recount;
  const char* const ending = counts ? ".counts" : ".cubes";
  const std::string range = grid_name(first, ending);
  if (!unit.of_labels()) return fanned_out(job.folder, first, range);
  const std::filesystem::path folder = label_folder(job.folder, unit.first_label);
  const std::string label = std::to_string(unit.first_label);
  return unit.whole ? folder / (label + ending) : fanned_out(folder / label, first, range);
}

std::filesystem::path tile_artifact_path(const std::filesystem::path& folder, const UnitPlan& plan,
                                         std::uint64_t unit) {
  return plan.path(folder, unit, ".tile");
}

std::filesystem::path asset_record_path(const EncodeJob& job, const UnitPlan& plan,
                                        std::uint64_t unit) {
  return plan.path(job.folder, unit, ".record");
}

std::filesystem::path merged_record_path(const EncodeJob& job) {
  return job.folder / "merged.record";
}

Hash128 hash_of(const MaterialRules& rules) {
  KeyHasher hash;
  hash.text("materials").integer(rules.others ? 1 : 0);
  for (const MaterialRange& range : rules.ranges)
    hash.integer(static_cast<std::int64_t>(range.first))
        .integer(static_cast<std::int64_t>(range.last))
        .integer(range.own ? 1 : 0)
        .integer(static_cast<std::int64_t>(range.material));
  return hash.finish();
}

}  // namespace voxweld
