// A block's samples as bits: those on one side of the surface.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "stages/filter/stored_value.h"
#include "storage/types/box.h"

namespace voxweld {

inline constexpr std::int64_t most_block_side = 64;  // a row of samples is one word

struct BlockMask {
  Index3 size;  // at most most_block_side a side
  // Rows along x, that of y, z at y + size.y * z. Bit x is sample x; bits beyond size.x are 0.
  std::vector<std::uint64_t> rows;
};

struct SurfaceSide {
  Isovalue isovalue;
  Inside inside = Inside::above;
  bool within = true;  // the samples inside; else those outside, NaNs among them
};

// Fills `mask` with the samples of `part`, which lies in [0, held). samples: of [0, held), x fastest,
// tightly packed. Widens `range`, where there is one, to hold those of the part.
void mask_samples(SampleType type, std::span<const std::byte> samples, Index3 held,
                  const Box3& part, const SurfaceSide& side, BlockMask& mask,
                  StoredRange* range = nullptr);

}  // namespace voxweld
