#include "stages/build/edge_kernels.inc"

namespace voxweld {

EdgeKernel edge_kernel_base() {
  return smooth_edges;
}

}  // namespace voxweld
