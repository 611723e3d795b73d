// How noisy the samples around a surface are.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "storage/types/box.h"
#include "storage/types/isovalue.h"
#include "storage/types/sample_type.h"

namespace voxweld {

// From the third differences of the four samples around each step that crosses the surface: noise
// makes them large, a smooth field hardly. Where a field is not smooth they are larger still, so a
// low quantile is taken, which creases and thin parts do not move much. The samples of a blurred
// or a binary image are not smooth either, wherever they cross: that counts as noise too.
//
// Exact and independent of the order of what is added: counts of bins.
class NoiseMeter {
 public:
  // isovalue: of the samples as stored.
  NoiseMeter(SampleType type, const Isovalue& isovalue);

  // Of a box of samples, x fastest, tightly packed. Only steps well inside it count.
  void add(Index3 size, const std::byte* samples);
  // How many steps were looked at.
  std::uint64_t count() const { return count_; }

  // The standard deviation that the samples' noise would have, were it all there is; 1 or 1.5 times
  // a power of two, so that a few samples that change do not change it. 0 where nothing was seen.
  // Integers have at least the noise of rounding.
  double level() const;

 private:
  template <class T>
  void add_typed(Index3 size, const T* samples);
  double quantile() const;

  SampleType type_;
  double isovalue_;
  std::vector<std::uint64_t> bins_;  // by the upper bits of the double
  std::uint64_t count_ = 0;
};

}  // namespace voxweld
