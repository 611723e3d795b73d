#ifdef __AVX512F__
#include "stages/refine/nearest_kernels.inc"
#else
#include "stages/refine/nearest_kernels.h"
#endif

namespace voxweld {

NearestKernel nearest_kernel_avx512() {
#ifdef __AVX512F__
  return nearest_of_eight;
#else
  return nullptr;
#endif
}

}  // namespace voxweld
