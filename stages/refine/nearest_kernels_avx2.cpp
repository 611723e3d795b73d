#ifdef __AVX2__
#include "stages/refine/nearest_kernels.inc"
#else
#include "stages/refine/nearest_kernels.h"
#endif

namespace voxweld {

NearestKernel nearest_kernel_avx2() {
#ifdef __AVX2__
  return nearest_of_eight;
#else
  return nullptr;
#endif
}

}  // namespace voxweld
