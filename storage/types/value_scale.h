// What the stored samples of a file stand for: real = slope * stored + intercept. Of a CT that is
// how its numbers become HU. Samples stay as they are stored; whatever a user types or reads is
// real.
#pragma once

#include <cmath>

namespace voxweld {

struct ValueScale {
  double slope = 1, intercept = 0;  // finite, slope not 0

  bool identity() const { return slope == 1 && intercept == 0; }
  // Rounded after the product and after the sum. Never falls while `stored` rises, or, with a
  // negative slope, never rises.
  double real(double stored) const { return identity() ? stored : slope * stored + intercept; }
  // The other way; of what real() gives, to rounding.
  double stored(double real) const { return identity() ? real : (real - intercept) / slope; }

  friend bool operator==(const ValueScale&, const ValueScale&) = default;
};

// What formats mean by these two numbers: a slope of 0 and numbers that are none scale nothing.
inline ValueScale value_scale(double slope, double intercept) {
  if (slope == 0 || !std::isfinite(slope) || !std::isfinite(intercept)) return {};
  return {slope, intercept};
}

}  // namespace voxweld
