#include "stages/build/edge_kernels.h"

#include "stages/contouring/chosen_unit.h"

namespace voxweld {

EdgeKernel edge_kernel() {
  return of_chosen_unit(edge_kernel_base(), edge_kernel_avx2(), edge_kernel_avx512());
}

}  // namespace voxweld
