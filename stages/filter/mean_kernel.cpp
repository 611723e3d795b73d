#include <utility>

#include "stages/filter/box_sum_kernel.h"

namespace voxweld {

std::unique_ptr<FilterKernel> mean_kernel(const SampleGrid& input, Index3 radius, SampleType type) {
  double count = 1;
  for (int axis = 0; axis < 3; ++axis) count *= 2 * static_cast<double>(radius[axis]) + 1;
  return filter_detail::box_sum_kernel(input, {radius}, count, type);
}

}  // namespace voxweld
