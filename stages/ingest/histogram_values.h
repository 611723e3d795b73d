// A histogram's bins as real values. Internal to the thresholds.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "storage/types/histogram.h"
#include "storage/types/value_scale.h"

namespace voxweld {

struct ValueCount {
  double value = 0, count = 0;
  // What the bin covers: all samples in it lie in [lo, hi]. Of types whose bins are single values,
  // half a step either side.
  double lo = 0, hi = 0;
};

// Those of the finite bins, ascending.
std::vector<ValueCount> finite_values(const Histogram& histogram, const ValueScale& scale);

// The smallest of the values that at least a share q of the samples does not exceed; none where
// there is none. Precondition: 0 <= q <= 1.
std::optional<double> quantile_of(std::span<const ValueCount> values, double q);

}  // namespace voxweld
