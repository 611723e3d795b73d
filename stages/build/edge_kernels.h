// Crossings and normals of eight lattice edges at once, where the surface is smooth: what
// EdgeEstimator makes of an edge with surface.gradient = "subcell" that sees no kink, to the bit.
#pragma once

#include <array>
#include <cstdint>

#include "stages/contouring/lanes.h"
#include "storage/types/box.h"

namespace voxweld {

// The samples around eight edges along one axis.
struct alignas(64) EdgeStencils {
  std::array<LaneArray, 6> along{};  // from two before the low end to two behind the high end
  // Beside the low end and the high end, on the two other axes, ascending: before and behind.
  std::array<std::array<std::array<LaneArray, 2>, 2>, 2> beside{};
};

struct EdgeRule {
  int axis = 0;
  double isovalue = 0;
  double outward = 1;  // 1 or -1: what samples do there
  Vec3 spacing{1, 1, 1};
  double noise = 0;  // standard deviation of a sample
};

struct alignas(64) EdgeLanes {
  LaneArray t{};
  std::array<LaneArray, 3> normal{};
  std::array<std::int64_t, lanes> smooth{};  // 0: there may be a kink; the rest is of no meaning
};

using EdgeKernel = void (*)(const EdgeStencils&, const EdgeRule&, EdgeLanes&);

// Of the same vector unit as qef_kernels().
EdgeKernel edge_kernel();
EdgeKernel edge_kernel_base();
EdgeKernel edge_kernel_avx2();  // null where the compiler makes none
EdgeKernel edge_kernel_avx512();

}  // namespace voxweld
