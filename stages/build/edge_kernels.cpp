#include "stages/build/edge_kernels.h"

#include <string_view>

#include "stages/contouring/qef.h"

namespace voxweld {

EdgeKernel edge_kernel() {
  const std::string_view unit = qef_kernels().name;
  const EdgeKernel kernel = unit == "avx512" ? edge_kernel_avx512()
                            : unit == "avx2" ? edge_kernel_avx2()
                                             : edge_kernel_base();
  return kernel != nullptr ? kernel : edge_kernel_base();
}

}  // namespace voxweld
