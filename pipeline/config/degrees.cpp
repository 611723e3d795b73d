#include "pipeline/config/degrees.h"

#include <array>
#include <cmath>
#include <numbers>

namespace voxweld {
namespace {

constexpr double radians_per_degree = std::numbers::pi / 180;

// 1 / n!, n from 0. All n! here are exact in a double.
constexpr std::array<double, 18> inverse_factorials = [] {
  std::array<double, 18> values{};
  double factorial = 1;
  for (std::size_t n = 0; n < values.size(); ++n) {
    if (n > 0) factorial *= static_cast<double>(n);
    values[n] = 1 / factorial;
  }
  return values;
}();

// Taylor's series for |x| <= pi / 4; the terms left out are below 2^-58.
double alternating_series(std::size_t last, double x_squared) {
  double sum = inverse_factorials[last];
  while (last >= 2) {
    last -= 2;
    sum = inverse_factorials[last] - sum * x_squared;
  }
  return sum;
}

}  // namespace

SineCosine sine_cosine_of_degrees(double degrees) {
  // Exact, both: fmod by its definition; the nearest multiple of 90 is 0, or within half and double
  // of what it is taken from.
  const double within_turn = std::fmod(degrees, 360.0);
  const double quarters = std::nearbyint(within_turn / 90);
  const double x = (within_turn - 90 * quarters) * radians_per_degree;

  const double sine = x * alternating_series(17, x * x);
  const double cosine = alternating_series(16, x * x);
  // Adding 0 makes 0 of -0.
  switch (static_cast<int>(quarters) & 3) {
    case 0:
      return {sine + 0.0, cosine + 0.0};
    case 1:
      return {cosine + 0.0, -sine + 0.0};
    case 2:
      return {-sine + 0.0, -cosine + 0.0};
    default:
      return {-cosine + 0.0, sine + 0.0};
  }
}

}  // namespace voxweld
