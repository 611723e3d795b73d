#include "stages/build/plane_kernels.inc"

namespace voxweld {

PlaneKernel plane_kernel_base() {
  return planes_of_nodes;
}

}  // namespace voxweld
