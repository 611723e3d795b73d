// Which labels there are around a brick, and where: what is built for each of them looks at its own
// box only, so that sixty labels of a brick do not cost sixty bricks.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "stages/build/build_brick.h"

namespace voxweld {

class LabelExtents {
 public:
  // block: u32, labels numbered from 0 (material_block.h), all below `labels`.
  // The labels of the samples of lattice points -1 .. side + 1, ascending, without `left_out` and
  // without those that no cell of the brick has at a corner; they live until the next call.
  std::span<const std::uint32_t> find(const HaloBlock& block, const BrickPlace& place,
                                      std::uint32_t labels, std::uint32_t left_out);

  // Of a label found: the samples that hold all of it that the brick's signs are read from.
  Box3 samples(std::uint32_t label) const;
  // All of those are of this label, and none lies beyond the volume.
  bool everywhere(std::uint32_t label) const {
    return found_[label].count == static_cast<std::uint32_t>(of_signs_.count());
  }

  // What is held for a block of so many samples, each of a label of its own, in bytes.
  static std::uint64_t memory_bytes(std::uint64_t samples);

 private:
  struct Found {
    std::array<std::int16_t, 3> lo{}, hi{};  // half-open, from of_signs_.lo
    std::uint32_t count = 0;                 // 0: not met
  };
  void add_row(const std::uint32_t* row, Index3 first, std::int64_t end);

  Box3 of_signs_;
  std::vector<Found> found_;  // by label
  std::vector<std::uint32_t> met_;
};

}  // namespace voxweld
