// A volume whose file has its axes in another order.
#pragma once

#include <array>
#include <memory>

#include "storage/types/volume.h"

namespace voxweld {

// The samples of `source` with axis i of it as axis along[i] of the result, of which `info` is
// (size, place and so on). Reads as the source does, any box from any thread.
// Preconditions: the source has Access::box, along is a permutation of 0, 1, 2, sizes agree.
std::unique_ptr<SampleSource> transposed_source(std::shared_ptr<SampleSource> source,
                                                const std::array<int, 3>& along, VolumeInfo info);

}  // namespace voxweld
