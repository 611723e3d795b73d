// The QEF planes of eight nodes of 2^3 cells at once, from the Hermite data of their edges, and whether
// the normals of each node are near one direction.
#pragma once

#include <array>
#include <cstdint>

#include "stages/contouring/qef.h"

namespace voxweld {

// Which edge of its node one is: its axis, and the lattice point of its low end among the node's 27.
struct EdgePlace {
  static constexpr std::int32_t none = -1;
  static constexpr std::int32_t make(int axis, int x, int y, int z) {
    return x | y << 2 | z << 4 | axis << 6;
  }
  // How many of the node's cells have it.
  static constexpr int cells(std::int32_t place) {
    int cells = 1;
    for (int a = 0; a < 3; ++a)
      if (a != place >> 6 && (place >> 2 * a & 3) == 1) cells *= 2;
    return cells;
  }
};

// The edges of eight nodes, each node's by axis and then in the order edges are kept.
struct alignas(64) NodeEdges {
  struct Row {
    std::array<std::int32_t, lanes> place;
    // The crossing, from 0 at the low end, and the normal. Anything where there is no edge.
    std::array<std::array<float, lanes>, 4> edge{};
    Row() { place.fill(EdgePlace::none); }
  };
  std::size_t rows = 0;  // of the longest node; in those behind there is no edge
  std::array<Row, max_planes> row;
};

// The sum of a node's normals, each as often as cells of the node have the edge; and whether all of them
// are near it (one_direction of normal_clusters.h, of NormalSense::outward).
struct alignas(64) NodeDirections {
  std::array<std::array<float, lanes>, 3> total{};
  std::array<std::int32_t, lanes> is_one{};
};

// spacing: of samples; cosine: of the angle that is near. An edge weighs as many cells of the node as it
// is of: so the planes are what those of the cells add up to. Points are relative to the node's centre.
using PlaneKernel = void (*)(const NodeEdges& edges, Vec3 spacing, float cosine, PlaneBatch& planes,
                             NodeDirections& directions);

// Of the same vector unit as qef_kernels().
PlaneKernel plane_kernel();
PlaneKernel plane_kernel_base();
PlaneKernel plane_kernel_avx2();  // null where the compiler makes none
PlaneKernel plane_kernel_avx512();

}  // namespace voxweld
