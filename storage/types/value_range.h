// Joining the value ranges of parts of a volume. Order does not matter.
#pragma once

#include <algorithm>

#include "storage/types/volume.h"

namespace voxweld {

constexpr ValueRange merge(const ValueRange& a, const ValueRange& b) {
  ValueRange merged = a.empty ? b : a;
  if (!a.empty && !b.empty) {
    merged.lo = std::min(a.lo, b.lo);
    merged.hi = std::max(a.hi, b.hi);
  }
  merged.any_nan = a.any_nan || b.any_nan;
  return merged;
}

}  // namespace voxweld
