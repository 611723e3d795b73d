// Sources around sources, and one around nothing.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "storage/types/volume.h"

namespace voxweld {

// The samples of `box` alone. They keep their coordinates (geometry.first is of the box's lowest
// sample) and so their place in the world. Same access as the source; of a source read by rows, slices or stream, up to one slice is held beside
// the caller's buffer, and info().largest_decode says so.
// InputError unless the box is not empty and inside the volume.
std::unique_ptr<SampleSource> crop_source(std::shared_ptr<SampleSource> source, const Box3& box);

// The samples of a source of which the info says something else.
std::unique_ptr<SampleSource> source_with_info(std::shared_ptr<SampleSource> source,
                                               VolumeInfo info);

struct GeometryOverrides {
  std::optional<Vec3> spacing{};  // in the (possibly renamed) unit; positive and finite
  std::string unit{};             // when given: of spacing and origin, which keep their numbers
};
// InputError for a spacing that is not positive.
std::unique_ptr<SampleSource> override_source(std::shared_ptr<SampleSource> source,
                                              const GeometryOverrides& overrides);

// Space with nothing in it, where solids are to be made by edits alone: zeros of type u8, which
// hold no surface at an isovalue of 1. Any box, from any thread; its ranges say that nothing need
// be read.
std::unique_ptr<RangedSource> empty_source(const VolumeGeometry& geometry);

}  // namespace voxweld
