// What is learnt of samples while they pass.
#pragma once

#include <cstddef>
#include <span>

#include "storage/types/histogram.h"
#include "storage/types/volume.h"

namespace voxweld {

// Takes the statistics of samples as they pass (stages/ingest has one).
class SampleStatistics {
 public:
  virtual ~SampleStatistics() = default;
  // Adds samples (native byte order, a whole number of them) and returns their range.
  virtual ValueRange add(std::span<const std::byte> samples) = 0;
  // The histogram of all added since the last call.
  virtual Histogram take() = 0;
};

}  // namespace voxweld
