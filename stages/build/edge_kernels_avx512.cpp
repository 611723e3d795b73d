#ifdef __AVX512F__
#include "stages/build/edge_kernels.inc"
#else
#include "stages/build/edge_kernels.h"
#endif

namespace voxweld {

EdgeKernel edge_kernel_avx512() {
#ifdef __AVX512F__
  return smooth_edges;
#else
  return nullptr;
#endif
}

}  // namespace voxweld
