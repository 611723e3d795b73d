// The samples one brick is built from.
#pragma once

#include <cstddef>

#include "storage/types/box.h"
#include "storage/types/sample_type.h"

namespace voxweld {

// Lattice coordinate u = sample index + 1: the ring u = 0 and all above `size` is outside.
struct HaloBlock {
  SampleType type = SampleType::u8;
  Index3 size;                      // samples a side of the whole volume
  Box3 samples;                     // the sample indices held, clipped to the volume
  const std::byte* data = nullptr;  // of sample samples.lo
  std::int64_t row = 0;             // samples from one y to the next
  std::int64_t slice = 0;           // samples from one z to the next
};

}  // namespace voxweld
