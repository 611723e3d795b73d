// Whether positions in a row are equally far apart, and along which line they lie.
#pragma once

#include <cstdint>
#include <vector>

#include "storage/types/box.h"

namespace voxweld {

struct SliceSteps {
  Vec3 step;             // from slice to slice where they are even; else of the smallest distance
  double distance = 0;   // of slices along the normal, as `step`
  double deviation = 0;  // of the positions from evenly spaced ones, at most; in mm
  // What they may be off: 1 % of the distance of slices or 0.01 mm, whichever is larger, but no more
  // than a tenth of the distance. Where all differences of positions are multiples of 0.1 mm, so
  // that they evidently were rounded, 0.1 mm, if slices are at least 1 mm apart.
  double tolerance = 0;
  bool even = false;
  // Of uneven ones:
  double smallest = 0, middle = 0, largest = 0;  // distances along the normal
  std::size_t widest = 0;                        // the largest is that from this slice to the next
  std::int64_t missing = 0;  // slices that the gaps leave room for, where all are multiples
  double sideways = 0;       // how far a slice lies off the line through first and last, at most
  std::size_t sideways_at = 0;
};

// Positions by rising distance along the normal, no two at one place. Precondition: two at least.
SliceSteps examine_steps(const std::vector<Vec3>& positions, Vec3 normal);

}  // namespace voxweld
