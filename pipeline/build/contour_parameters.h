// From a config and its volume to what the contouring depends on.
#pragma once

#include "pipeline/config/config.h"
#include "pipeline/stage/volume.h"
#include "stages/contouring/parameters.h"

namespace voxweld {

// simplify.tolerance in the units of the output.
double absolute_tolerance(const Config& config, const VolumeGeometry& geometry);

// Reads the meshes that edits name; throws what that throws.
// The config's isovalue is of the file's real values; here it becomes one of stored samples.
// Preconditions: the isovalue is resolved; `labels` are of the same config. input: as
// Volume::solid.
ContourParameters contour_parameters(const Config& config, const VolumeInfo& info,
                                     const std::optional<Solid>& input, LabelParameters labels);

}  // namespace voxweld
