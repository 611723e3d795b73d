#include "stages/refine/nearest_kernels.inc"

namespace voxweld {

NearestKernel nearest_kernel_base() {
  return nearest_of_eight;
}

}  // namespace voxweld
