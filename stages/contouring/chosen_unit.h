// Which of a kernel's versions for vector units is called.
#pragma once

#include <string_view>

#include "stages/contouring/qef.h"

namespace voxweld {

// That of the unit of qef_kernels(). Null where the compiler makes none: then the base.
template <class Kernel>
Kernel of_chosen_unit(Kernel base, Kernel avx2, Kernel avx512) {
  const std::string_view unit = qef_kernels().name;
  const Kernel kernel = unit == "avx512" ? avx512 : unit == "avx2" ? avx2 : base;
  return kernel != nullptr ? kernel : base;
}

}  // namespace voxweld
