#include "storage/dicom/slice_steps.h"

#include <algorithm>
#include <cmath>

#include "storage/volumes/axes.h"

namespace voxweld {
namespace {

bool rounded_to_tenths(const std::vector<Vec3>& positions) {
  for (const Vec3& p : positions)
    for (int axis = 0; axis < 3; ++axis) {
      const double tenths = 10 * (p[axis] - positions.front()[axis]);
      if (!(std::abs(tenths - std::round(tenths)) < 1e-3)) return false;
    }
  return true;
}

double tolerance_of(double distance, const std::vector<Vec3>& positions) {
  const double usual = std::max(0.01 * distance, std::min(0.01, 0.1 * distance));
  return distance >= 1 && rounded_to_tenths(positions) ? std::max(usual, 0.1) : usual;
}

void examine_gaps(const std::vector<double>& along, SliceSteps& steps) {
  std::vector<double> gaps;
  for (std::size_t i = 1; i < along.size(); ++i) gaps.push_back(along[i] - along[i - 1]);
  steps.widest = static_cast<std::size_t>(std::ranges::max_element(gaps) - gaps.begin());
  steps.largest = gaps[steps.widest];
  steps.smallest = *std::ranges::min_element(gaps);
  std::vector<double> sorted = gaps;
  // The lower of two in the middle: that slices are missing makes no gap smaller.
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>((sorted.size() - 1) / 2);
  std::ranges::nth_element(sorted, middle);
  steps.middle = *middle;
  const double tolerance = std::min(steps.tolerance, 0.1 * steps.middle);
  for (const double gap : gaps) {
    const double multiple = std::round(gap / steps.middle);
    if (multiple < 1 || std::abs(gap - multiple * steps.middle) > tolerance) {
      steps.missing = 0;
      return;
    }
    if (multiple < 1e9) steps.missing += static_cast<std::int64_t>(multiple) - 1;
  }
}

}  // namespace

SliceSteps examine_steps(const std::vector<Vec3>& positions, Vec3 normal) {
  SliceSteps steps;
  std::vector<double> along;
  for (const Vec3& p : positions) along.push_back(dot(p - positions.front(), normal));
  const Vec3 whole = positions.back() - positions.front();
  const double gaps = static_cast<double>(positions.size() - 1);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3 p = positions[i] - positions.front();
    steps.deviation =
        std::max(steps.deviation, length(p - whole * (static_cast<double>(i) / gaps)));
    const double off = length(p - whole * (along[i] / along.back()));
    if (off > steps.sideways) {
      steps.sideways = off;
      steps.sideways_at = i;
    }
  }
  steps.step = whole * (1 / gaps);
  steps.distance = along.back() / gaps;
  steps.tolerance = tolerance_of(steps.distance, positions);
  examine_gaps(along, steps);
  steps.even = steps.deviation <= steps.tolerance;
  if (!steps.even) {
    steps.distance = steps.smallest;
    steps.step = whole * (steps.smallest / along.back());
  }
  return steps;
}

}  // namespace voxweld
