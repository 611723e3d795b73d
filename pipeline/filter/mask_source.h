// The filter mask: samples where another volume has none of some values become one value.
#pragma once

#include <memory>

#include "pipeline/filter/filter_request.h"
#include "storage/types/volume.h"

namespace voxweld {

// The source and request.mask are of Access::box; so is the result, whose files are those of both.
// InputError where the mask has another size, has no integers, or where the samples cannot be what
// is asked for outside.
std::shared_ptr<SampleSource> mask_source(std::shared_ptr<SampleSource> source,
                                          const FilterRequest& request);

}  // namespace voxweld
