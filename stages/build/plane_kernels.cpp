#include "stages/build/plane_kernels.h"

#include "stages/contouring/chosen_unit.h"

namespace voxweld {

PlaneKernel plane_kernel() {
  return of_chosen_unit(plane_kernel_base(), plane_kernel_avx2(), plane_kernel_avx512());
}

}  // namespace voxweld
