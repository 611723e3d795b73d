// The nearest of some triangles by looking at all of them.
#pragma once

#include <limits>
#include <span>

#include "stages/refine/nearest_triangle.h"

namespace voxweld::testing {

// squared: infinite where there is none. triangle: which; of equal ones the first.
struct Nearest {
  double squared = 0;
  std::size_t triangle = 0;
};

inline Nearest nearest_triangle(const LatticePoint& point,
                                std::span<const LatticeTriangle> triangles) {
  Nearest best{std::numeric_limits<double>::infinity(), 0};
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const double d = squared_distance(point, triangles[i]);
    if (d < best.squared) best = {d, i};
  }
  return best;
}

}  // namespace voxweld::testing
