// One unit of encode: the files of one tile, or of all tiles as the merged mesh, and their record,
// which says what they were made of.
#pragma once

#include "pipeline/stage/artifacts.h"
#include "pipeline/stage/context.h"
#include "storage/artifact/tile_artifact.h"

namespace voxweld {

TileArtifact tile_of(const EncodeJob& job, const UnitPlan& plan, std::uint64_t unit);

// Whether the record is there, of these inputs, and the files are as it says.
bool unit_is_current(const EncodeJob& job, const UnitPlan& plan, std::uint64_t unit);
bool merged_is_current(const EncodeJob& job, const UnitPlan& plan);

// Precondition: stitch is current. DamagedArtifact where a tile is not what was planned.
void encode_unit(const RunContext& context, const EncodeJob& job, const UnitPlan& plan,
                 std::uint64_t unit, const WorkerContext& worker);
void encode_merged(const RunContext& context, const EncodeJob& job, const UnitPlan& plan,
                   const WorkerContext& worker);

}  // namespace voxweld
