// Sources around sources.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "storage/types/volume.h"

namespace voxweld {

// The samples of `box` alone; they keep their place in the world (the origin moves along). Same
// access as the source; of a source read by rows, slices or stream, up to one slice is held beside
// the caller's buffer, and info().largest_decode says so.
// InputError unless the box is not empty and inside the volume.
std::unique_ptr<SampleSource> crop_source(std::shared_ptr<SampleSource> source, const Box3& box);

struct GeometryOverrides {
  std::optional<Vec3> spacing{};  // in the (possibly renamed) unit; positive and finite
  std::string unit{};             // when given: of spacing and origin, which keep their numbers
};
// InputError for a spacing that is not positive.
std::unique_ptr<SampleSource> override_source(std::shared_ptr<SampleSource> source,
                                              const GeometryOverrides& overrides);

}  // namespace voxweld
