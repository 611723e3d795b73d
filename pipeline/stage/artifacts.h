// Where the artifacts of a run lie, and by which keys they are known: the one place for both.
//
//   <work>/ingest-<hash>/volume.zarr, records/, histogram, labels.all, labels/, mesh-<hash>/
//   <work>/ingest-<hash>/ranges/.../<x>-<y>-<z>.<bricks' side>, of a volume that is read in place
//   <work>/build-<hash>/<fanned out>/<x>-<y>-<z>.octree
//   <work>/merge-<hash>/top.tree
//   <work>/stitch-<hash>/.../<tile>.tile
//   and where the mesh is refined
//   <work>/stitch-<hash>/.../<tile>.cubes
//   <work>/refine-<hash>/.../<first cube of the range, or label>.cubes, seams-<hash>/ and mend-<hash>/ alike
//   <work>/retile-<hash>/tile.plan, .../<tile>.tile
//   and where a number of triangles is to be left
//   <work>/survey-<hash>/.../<as of refine>.counts, recount-<hash>/ alike
//   <work>/refine-<hash>/tolerance, seams-<hash>/tolerance
//   and of all runs
//   <work>/encode-<hash>/.../<tile>.record, merged.record
//
// A folder's hash is of what its stage and those before it read of the config, so that a task of an
// older config cannot overwrite what a newer one made. An artifact's own key says the rest: the
// edits that reach a shard, the content of a tile's inputs.
#pragma once

#include <filesystem>
#include <string>

#include "pipeline/stage/refine_units.h"
#include "pipeline/stage/stage_jobs.h"
#include "pipeline/stage/unit_plan.h"
#include "stages/solids/solid.h"
#include "storage/artifact/container.h"

namespace voxweld {

// Goes up whenever encode's bytes change. (The versions of the others stand beside their formats.)
inline constexpr std::uint32_t encode_version = 6;
// And whenever vertices lie elsewhere on the lattice.
inline constexpr std::uint32_t stitch_version = 1;
// And whenever the bytes of refine change.
inline constexpr std::uint32_t refine_version = 15;
// And those of levels, beside what refine does.
inline constexpr std::uint32_t levels_version = 7;

// Folders of a run's artifacts, each named for what its stage and those before it read.
struct StagePaths {
  std::filesystem::path ingest, build, merge, stitch, survey, refine, recount, seams, mend, remend,
      retile, levels, encode;
  // Of the parameters, all stages before included.
  Hash128 build_key, merge_key, stitch_key, survey_key, refine_key, recount_key, seams_key,
      mend_key, remend_key, retile_key, levels_key, encode_key;
};
// Of stages that the config has not: nothing.
// info: with output_geometry; for the ingest folder alone it is not looked at.
// cube_level: of refine.
StagePaths stage_paths(const Config& config, const VolumeInfo& info, const LabelParameters& labels,
                       int cube_level = refine_cube_level);

// Of ingest's folder.
std::filesystem::path store_path(const std::filesystem::path& ingest);
std::filesystem::path store_records_path(const std::filesystem::path& ingest);
std::filesystem::path histogram_path(const std::filesystem::path& ingest);
std::filesystem::path label_counts_path(const std::filesystem::path& ingest);
std::filesystem::path label_counts_path(const std::filesystem::path& ingest, Index3 shard);
Hash128 label_counts_key(Hash128 samples);

std::filesystem::path shard_artifact_path(const BuildJob& job, Index3 shard);
// The shard's artifact.
ArtifactReader open_octrees(const BuildJob& job, Index3 shard);
// Of the shard's octree: the parameters, and the edits that reach it. What an edit does not reach
// stays as it is when the edit comes, changes or goes.
Hash128 shard_key(const BuildJob& job, Index3 shard);
// The same of one brick.
Hash128 brick_key(const BuildJob& job, Index3 brick);
// The ranges of its bricks, and what they are of beside the samples.
std::filesystem::path brick_ranges_path(const BuildJob& job, Index3 shard);
Hash128 brick_ranges_key(const BuildJob& job);
// The samples build reads for the shard, or would were no brick left out.
Box3 shard_samples(const BuildJob& job, Index3 shard);
// Where the shard's signs are looked at, for edits: spacing * sample index.
Bounds shard_bounds(const BuildJob& job, Index3 shard);

// What stitch makes of a unit: the tile's mesh as it is encoded, or sorted by cubes.
std::filesystem::path stitch_artifact_path(const StitchJob& job, const UnitPlan& plan,
                                           std::uint64_t unit);
// Of survey and recount as of refine and seams.
std::filesystem::path refine_artifact_path(const RefineJob& job, const RefineUnit& unit);
// What encode takes, in the folder of the stage that made it.
std::filesystem::path tile_artifact_path(const std::filesystem::path& folder, const UnitPlan& plan,
                                         std::uint64_t unit);
std::filesystem::path asset_record_path(const EncodeJob& job, const UnitPlan& plan,
                                        std::uint64_t unit);
std::filesystem::path merged_record_path(const EncodeJob& job);

// Equal for equal rules.
Hash128 hash_of(const MaterialRules& rules);

}  // namespace voxweld
