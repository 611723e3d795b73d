// Value range and histogram of samples.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "storage/types/histogram.h"
#include "storage/types/sample_statistics.h"
#include "storage/types/volume.h"

namespace voxweld {

// Range of each piece, histogram of all. Memory: 8 bytes a bin (8 MiB at most). One for each
// thread.
// Samples are in native byte order, of any alignment. Ranges are conservative where a double does
// not hold the value: lo is rounded down, hi up (64-bit integers beyond 2^53). -0 counts as 0.
// Precondition: a whole number of samples.
class HistogramStatistics final : public SampleStatistics {
 public:
  explicit HistogramStatistics(SampleType type);

  ValueRange add(std::span<const std::byte> samples) override;
  Histogram take() override;

 private:
  SampleType type_;
  std::vector<std::uint64_t> counts_;
  std::uint32_t lowest_, highest_;  // bins that may be in use
  std::uint64_t nans_ = 0;
};

}  // namespace voxweld
