// Space with nothing in it, as a volume: where solids are to be made by edits alone.
#pragma once

#include <memory>

#include "storage/types/volume.h"

namespace voxweld {

// Zeros of type u8, which hold no surface at an isovalue of 1. Any box, from any thread; its ranges
// say that nothing need be read.
std::unique_ptr<RangedSource> empty_source(const VolumeGeometry& geometry);

}  // namespace voxweld
