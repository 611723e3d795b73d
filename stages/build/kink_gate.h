// How large a bend must be to count as a kink (subcell.h). Apart, for kernels that may include no more.
#pragma once

namespace voxweld {

inline constexpr double lowest_crossing = 1.0 / 256, highest_crossing = 255.0 / 256;

struct KinkGate {
  double noise = 0;  // standard deviation of a sample

  // Of a sum of samples that is 0 where they are on a line; weight: the root of the sum of the
  // squared weights; step: how far neighbouring samples are apart straight across the surface.
  bool opens(double bend, double weight, double step) const {
    const double size = bend < 0 ? -bend : bend;
    return !(size <= deviations * weight * noise + least_bend * step);
  }

  static constexpr double deviations = 3;
  // With these two the gyroid phantom, which is smooth, is left to central differences nearly
  // everywhere, and the part phantom's creases are seen (tests/measure/measure_crossings.cpp).
  static constexpr double least_bend = 0.2;
  static constexpr double least_ratio = 3;  // to the bend beside it, on the smoother side
  // A branch that bends more, of the step, has a kink of its own.
  static constexpr double most_bend = 0.15;
};

// Weights, as above: of a second difference, 1 -2 1; of what the continuations miss the samples at
// the far ends by, 1 -1 -1 1 for straight ones and 1 -3 2 2 -3 1 for curved ones.
inline constexpr double second_weight = 2.4494897427831781;
inline constexpr double straight_weight = 2;
inline constexpr double curved_weight = 5.2915026221291814;

}  // namespace voxweld
