// Which labels there are around a brick, and where: what is built for each of them looks at its own
// box only, so that sixty labels of a brick do not cost sixty bricks.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "stages/build/build_brick.h"

namespace voxweld {

struct LabelExtent {
  std::uint32_t label = 0;
  Box3 samples;             // holds all of the label's that the brick's signs are read from
  bool everywhere = false;  // those are all of this label, and none lies beyond the volume
};

class LabelExtents {
 public:
  // block: u32, labels numbered from 0 (material_block.h), all below `labels`.
  // The labels of the samples of lattice points -1 .. side + 1, ascending, without `left_out` and
  // without those that no cell of the brick has at a corner; they live until the next call.
  std::span<const LabelExtent> find(const HaloBlock& block, const BrickPlace& place,
                                    std::uint32_t labels, std::uint32_t left_out);

 private:
  struct Found {
    Box3 samples;
    std::int64_t count = 0;
  };
  void add_row(const std::uint32_t* row, Index3 first, std::int64_t end);

  std::vector<Found> found_;  // by label; count 0: not met
  std::vector<std::uint32_t> met_;
  std::vector<LabelExtent> extents_;
};

}  // namespace voxweld
