#ifdef __AVX2__
#include "stages/build/edge_kernels.inc"
#else
#include "stages/build/edge_kernels.h"
#endif

namespace voxweld {

EdgeKernel edge_kernel_avx2() {
#ifdef __AVX2__
  return smooth_edges;
#else
  return nullptr;
#endif
}

}  // namespace voxweld
