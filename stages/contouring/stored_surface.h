// A surface that is asked for in a file's real values, in the numbers that the file stores.
#pragma once

#include "stages/contouring/parameters.h"
#include "storage/types/sample_type.h"
#include "storage/types/value_scale.h"

namespace voxweld {

// Turns isovalue and inside, which are of real values, into those of stored samples of the type.
// Inside are then exactly the samples v for which scale.real(v), computed in double, is at or above
// (at or below) the real isovalue; a negative slope swaps the sides. Nothing changes where the
// scale is the identity.
// Precondition: the isovalue is finite.
void to_stored(SurfaceParameters& surface, const ValueScale& scale, SampleType type);

}  // namespace voxweld
