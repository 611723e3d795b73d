// Of few triangles the nearest to each of eight points at once.
#pragma once

#include <cstdint>

#include "stages/contouring/lanes.h"

namespace voxweld {

// A triangle to measure many points from: what does not depend on the point. ab and ac lead from the
// first corner to the others; normal is their cross product. All but the normal's square are integers
// of less than 53 bits as long as sides have 25, so nothing is lost.
struct MeasuredShape {
  double first[3], ab[3], ac[3], normal[3];
  double abab, abac, acac, nn;  // dot products
  double sides;                 // a number for what it separates
};

struct alignas(64) PointLanes {
  LaneArray at[3];
  LaneArray sides;  // of triangles only those with the same number count
};

// squared: infinite where there is none. triangle: which; of equal ones the first.
struct alignas(64) NearestLanes {
  LaneArray squared, triangle;
};

using NearestKernel = void (*)(const MeasuredShape* shapes, std::size_t count,
                               const PointLanes& points, NearestLanes& nearest);

// Of the same vector unit as qef_kernels(). All give the same bits.
NearestKernel nearest_kernel();
NearestKernel nearest_kernel_base();
NearestKernel nearest_kernel_avx2();  // null where the compiler makes none
NearestKernel nearest_kernel_avx512();

}  // namespace voxweld
