#include "stages/refine/nearest_kernels.h"

#include "stages/contouring/chosen_unit.h"

namespace voxweld {

NearestKernel nearest_kernel() {
  return of_chosen_unit(nearest_kernel_base(), nearest_kernel_avx2(), nearest_kernel_avx512());
}

}  // namespace voxweld
