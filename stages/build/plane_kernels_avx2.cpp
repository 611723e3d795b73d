#ifdef __AVX2__
#include "stages/build/plane_kernels.inc"
#else
#include "stages/build/plane_kernels.h"
#endif

namespace voxweld {

PlaneKernel plane_kernel_avx2() {
#ifdef __AVX2__
  return planes_of_nodes;
#else
  return nullptr;
#endif
}

}  // namespace voxweld
