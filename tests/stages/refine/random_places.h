// Points and triangles at random, the same in each run.
#pragma once

#include <random>

#include "stages/exact/triangle_pair.h"

namespace voxweld::testing {

class RandomPlaces {
 public:
  std::int32_t operator()(std::int32_t lo, std::int32_t hi) {
    return lo + static_cast<std::int32_t>(engine_() % static_cast<std::uint32_t>(hi - lo + 1));
  }
  LatticePoint point(std::int32_t lo, std::int32_t hi) {
    return {(*this)(lo, hi), (*this)(lo, hi), (*this)(lo, hi)};
  }
  LatticeTriangle triangle(std::int32_t lo, std::int32_t hi) {
    LatticeTriangle t;
    do t = {point(lo, hi), point(lo, hi), point(lo, hi)};
    while (has_no_area(t));
    return t;
  }

 private:
  std::mt19937 engine_{7};
};

}  // namespace voxweld::testing
