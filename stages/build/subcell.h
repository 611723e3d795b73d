// Where a line of samples has a kink, and the smooth branches that meet there.
//
// Based on: Harten, "ENO schemes with subcell resolution", 1989. A distance near a crease is the
// maximum or the minimum of two smooth functions. Each can be continued from its own side into the
// step between two samples where they meet: if both continuations pass below the sample at the far
// end the field is their maximum, if both pass above it their minimum.
//
// Here a kink is one only if neither noise nor curvature explains it: what is smooth is left to
// central differences, which are calmer.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "stages/build/kink_gate.h"

namespace voxweld {

// At f[k]; infinite where the volume ends.
template <class Samples>
double second_difference(const Samples& f, std::int64_t k) {
  if (f.index + k < 1 || f.index + k + 1 >= f.size) return std::numeric_limits<double>::infinity();
  return (f[k + 1] - f[k]) - (f[k] - f[k - 1]);
}

// value + slope x + bend x (x + 1) / 2: through the last sample at x = 0, those behind it at -1
// and, unless bend was left out, -2.
struct Branch {
  double value = 0, slope = 0, bend = 0;

  double at(double x) const { return value + x * (slope + 0.5 * bend * (x + 1)); }
  double slope_at(double x) const { return slope + bend * (x + 0.5); }
  // Where it is 0, of two places the nearer one; no number where there is none.
  double root() const {
    const double b = slope + 0.5 * bend;
    return -2 * value / (b + std::copysign(std::sqrt(b * b - 2 * bend * value), b));
  }
};

// What goes on from f[0] in the direction `towards` (1 or -1), from the samples behind it. A bend
// that noise could make is left out.
// Precondition: there are two samples behind it.
template <class Samples>
Branch branch_towards(const Samples& f, int towards, double step, const KinkGate& gate) {
  const double f0 = f[0], f1 = f[-towards], f2 = f[-2 * towards];
  Branch branch{f0, f0 - f1};
  const double bend = branch.slope - (f1 - f2);
  const double noise = KinkGate::deviations * second_weight * gate.noise;
  if (std::abs(bend) > noise && std::abs(bend) <= KinkGate::most_bend * step) branch.bend = bend;
  return branch;
}

struct KinkedCrossing {
  bool kinked = false;  // the rest is of no meaning unless it is
  bool low = false;     // the crossing is on the low end's branch
  double t = 0;
  double slope = 0;  // of that branch there
};

// Of the step from low[0] to the next sample, high[0]: `level` is between the two.
template <class Samples>
KinkedCrossing kinked_crossing(const Samples& low, const Samples& high, double level, double step,
                               const KinkGate& gate) {
  if (low.index < 2 || high.index + 2 >= high.size) return {};
  const double beside =
      std::min(std::abs(second_difference(low, -1)), std::abs(second_difference(high, 1)));
  const double own = std::abs(second_difference(low, 0) + second_difference(high, 0));
  if (!(own > 2 * KinkGate::least_ratio * beside)) return {};
  Branch a = branch_towards(low, 1, step, gate), b = branch_towards(high, -1, step, gate);
  const double miss_a = high[0] - a.at(1), miss_b = low[0] - b.at(1);
  const bool is_maximum = miss_a > 0 && miss_b > 0, is_minimum = miss_a < 0 && miss_b < 0;
  const double weight = a.bend == 0 && b.bend == 0 ? straight_weight : curved_weight;
  if (!(is_maximum || is_minimum) || !gate.opens(miss_a + miss_b, weight, step)) return {};
  a.value -= level;
  b.value -= level;
  // Where one branch is at the level, the other must not overrule it.
  const auto holds = [&](double x, const Branch& other) {
    return x >= 0 && x <= 1 && (is_maximum ? other.at(1 - x) <= 0 : other.at(1 - x) >= 0);
  };
  const double at_a = a.root(), at_b = b.root();
  if (holds(at_a, b)) return {true, true, at_a, a.slope_at(at_a)};
  if (holds(at_b, a)) return {true, false, 1 - at_b, -b.slope_at(at_b)};
  return {};
}

// Whether there is a kink in one of the steps beside f[0].
template <class Samples>
bool has_kink_beside(const Samples& f, double step, const KinkGate& gate) {
  if (f.index < 1 || f.index + 1 >= f.size) return false;
  const double own = second_difference(f, 0);
  if (!gate.opens(own, second_weight, step)) return false;
  const double beside =
      std::min(std::abs(second_difference(f, -1)), std::abs(second_difference(f, 1)));
  return !(std::abs(own) <= KinkGate::least_ratio * beside);
}

// The slope at f[0] of the branch, of those on both sides of it, that bends less. Where samples are
// infinite or no numbers, of any that has its samples in the volume.
// Precondition: has_kink_beside.
template <class Samples>
double smooth_side_difference(const Samples& f, double step, const KinkGate& gate) {
  const bool has_below = f.index >= 2, has_above = f.index + 2 < f.size;
  if (!has_below && !has_above) return 0.5 * (f[1] - f[-1]);
  const bool bends_less = !(std::abs(second_difference(f, -1)) > std::abs(second_difference(f, 1)));
  const bool below = has_below && (bends_less || !has_above);
  return below ? branch_towards(f, 1, step, gate).slope_at(0)
               : -branch_towards(f, -1, step, gate).slope_at(0);
}

}  // namespace voxweld
