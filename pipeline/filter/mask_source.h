// The filter mask: samples where another volume has none of some values become one value.
#pragma once

#include <cstddef>
#include <memory>

#include "pipeline/config/config.h"
#include "storage/types/volume.h"

namespace voxweld {

struct MaskRequest {
  const FilterConfig& filter;
  std::size_t number = 1;  // of it in the config, from 1: for messages
};

// Both of Access::box; so is the result, whose files are those of both. InputError where the mask
// has another size, has no integers, or where the samples cannot be what is asked for outside.
std::shared_ptr<SampleSource> mask_source(std::shared_ptr<SampleSource> source,
                                          std::shared_ptr<SampleSource> mask,
                                          const MaskRequest& request);

}  // namespace voxweld
