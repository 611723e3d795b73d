#include "stages/build/plane_kernels.h"

#include <string_view>

namespace voxweld {

PlaneKernel plane_kernel() {
  const std::string_view unit = qef_kernels().name;
  const PlaneKernel kernel = unit == "avx512" ? plane_kernel_avx512()
                             : unit == "avx2" ? plane_kernel_avx2()
                                              : plane_kernel_base();
  return kernel != nullptr ? kernel : plane_kernel_base();
}

}  // namespace voxweld
