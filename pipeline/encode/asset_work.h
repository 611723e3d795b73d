// One unit of encode: the files of one tile, or of all tiles as the merged mesh, and their record,
// which says what they were made of.
#pragma once

#include "pipeline/stage/artifacts.h"
#include "pipeline/stage/context.h"
#include "pipeline/stage/level_meshes.h"
#include "storage/artifact/tile_artifact.h"

namespace voxweld {

// Which of the formats have a merged mesh: all, or those that can be written without holding it.
enum class MergedParts : std::uint8_t { all, streamed };

TileArtifact tile_of(const EncodeJob& job, const UnitPlan& plan, std::uint64_t unit);

// Whether the record is there, of these inputs, and the files are as it says.
bool unit_is_current(const EncodeJob& job, const UnitPlan& plan, std::uint64_t unit);
bool level_is_current(const EncodeJob& job, const LevelMeshes& levels, std::uint64_t node);
bool merged_is_current(const EncodeJob& job, const UnitPlan& plan, MergedParts parts);

// Precondition: stitch is current. DamagedArtifact where a tile is not what was planned.
void encode_unit(const RunContext& context, const EncodeJob& job, const UnitPlan& plan,
                 std::uint64_t unit, const WorkerContext& worker);
// A tile of a coarser level.
void encode_level(const RunContext& context, const EncodeJob& job, const LevelMeshes& levels,
                  std::uint64_t node, const WorkerContext& worker);
void encode_merged(const RunContext& context, const EncodeJob& job, const UnitPlan& plan,
                   MergedParts parts, const WorkerContext& worker);

}  // namespace voxweld
