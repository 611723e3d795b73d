#include "stages/contouring/qef_kernels.inc"

namespace voxweld {

const QefKernels& qef_kernels_base() {
  static constexpr QefKernels kernels{reduce, merge, solve, border, "base"};
  return kernels;
}

}  // namespace voxweld
