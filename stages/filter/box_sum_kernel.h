// Sums of boxes of samples with weights along each axis: what a Gaussian and a mean are.
#pragma once

#include <array>
#include <vector>

#include "stages/filter/grid_kernel.h"

namespace voxweld::filter_detail {

struct SumAxes {
  Index3 radius;
  std::array<std::vector<double>, 3> weights{};  // by distance; empty: all 1
};

// The sums divided by `divisor`, rounded to the type of the result.
std::unique_ptr<FilterKernel> box_sum_kernel(const SampleGrid& input, SumAxes axes, double divisor,
                                             SampleType type);

}  // namespace voxweld::filter_detail
