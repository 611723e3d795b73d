// Volumes whose cells have several sheets.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "tests/support/contour_in_memory.h"

namespace voxweld::testing {

inline constexpr double infinite = std::numeric_limits<double>::infinity();

// Many small pieces, with handles.
inline MemoryVolume noise_volume(std::int64_t side, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  return MemoryVolume::made<float>(splat(side), SampleType::f32,
                                   [&](Index3) { return normal(random) - 0.8F; });
}

// Plates, some of them thinner than two voxels and at an angle, and smooth waves.
inline MemoryVolume plates(std::int64_t side, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  struct Plate {
    Vec3 normal;
    double at = 0, half = 0;
  };
  std::vector<Plate> all(5);
  for (Plate& plate : all) {
    const Vec3 n{unit(random), unit(random), unit(random)};
    plate = {n * (1 / std::sqrt(dot(n, n))), unit(random) * static_cast<double>(side) / 3,
             0.6 + 2 * std::abs(unit(random))};
  }
  const double middle = static_cast<double>(side) / 2, reach = middle - 2.3;
  return MemoryVolume::made<float>(splat(side), SampleType::f32, [&](Index3 s) {
    const Vec3 p =
        Vec3{static_cast<double>(s.x), static_cast<double>(s.y), static_cast<double>(s.z)} -
        Vec3{middle, middle, middle};
    double inside = -1e9;
    for (const Plate& plate : all)
      inside = std::max(inside, plate.half - std::abs(dot(plate.normal, p) - plate.at));
    return static_cast<float>(
        std::min(inside, reach - std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)})));
  });
}

inline ContourParameters by_sheets(double tolerance) {
  ContourParameters parameters;
  parameters.surface.isovalue = {0.0};
  parameters.surface.gradient = Gradient::subcell;
  parameters.simplify.tolerance = tolerance;
  parameters.simplify.topology = Topology::manifold;
  return parameters;
}

}  // namespace voxweld::testing
