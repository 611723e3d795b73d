// The line on which a slice has the isovalue.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pipeline/report/volume_samples.h"

namespace voxweld {

// In columns and rows of the slice, from the middle of its first sample.
struct ContourPoint {
  double x = 0, y = 0;
  friend bool operator==(const ContourPoint&, const ContourPoint&) = default;
};
struct ContourLine {
  std::vector<ContourPoint> points;
  bool closed = false;  // the last point is joined to the first; else both lie on the slice's edge
};

// Lines in the order of their first points, row after row. A sample is inside where it is above the
// isovalue, or with `below` where it is below it; NaN is outside.
std::vector<ContourLine> contour_of(const Slice& slice, double isovalue, bool below = false);

std::size_t points_of(const std::vector<ContourLine>& lines);

// The lines as an SVG path, in tenths of a sample, with rows rising from the bottom edge: the first
// sample's own square lies at 0, 10 * (rows - 1).
std::string contour_path(const std::vector<ContourLine>& lines, const Slice& slice);

}  // namespace voxweld
