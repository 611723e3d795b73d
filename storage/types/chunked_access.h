// How a source of chunks is best read.
#pragma once

#include <algorithm>
#include <cstdint>

#include "storage/types/volume.h"

namespace voxweld {

// The largest chunk, in samples a side, of which bricks are read in place.
inline constexpr std::int64_t largest_box_chunk = 128;

// Access::box where each brick costs little more than it holds: chunks are cubes or nearly so, and
// not large. Else Access::chunks: each is decoded a few times at most, and the samples are copied.
// Sizes in samples; chunk: what is decoded whole.
inline Access chunked_access(Index3 size, Index3 chunk) {
  for (int axis = 0; axis < 3; ++axis)
    if (std::min(size[axis], chunk[axis]) > largest_box_chunk) return Access::chunks;
  return Access::box;
}

}  // namespace voxweld
