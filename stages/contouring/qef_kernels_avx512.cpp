#ifdef __AVX512F__
#include "stages/contouring/qef_kernels.inc"
#else
#include "stages/contouring/qef.h"
#endif

namespace voxweld {

const QefKernels* qef_kernels_avx512() {
#ifdef __AVX512F__
  static constexpr QefKernels kernels{reduce, merge, solve, border, "avx512"};
  const bool supported = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                         __builtin_cpu_supports("avx512vl");
  return supported ? &kernels : nullptr;
#else
  return nullptr;
#endif
}

}  // namespace voxweld
