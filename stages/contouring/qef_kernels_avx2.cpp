#ifdef __AVX2__
#include "stages/contouring/qef_kernels.inc"
#else
#include "stages/contouring/qef.h"
#endif

namespace voxweld {

const QefKernels* qef_kernels_avx2() {
#ifdef __AVX2__
  static constexpr QefKernels kernels{reduce, merge, solve, border, "avx2"};
  const bool supported = __builtin_cpu_supports("avx2");
  return supported ? &kernels : nullptr;
#else
  return nullptr;
#endif
}

}  // namespace voxweld
