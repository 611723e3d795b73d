// How much a mesh on the output lattice holds and how large its surface is, in lattice steps.
#pragma once

#include <algorithm>

#include "storage/types/tile_mesh.h"

namespace voxweld {

using Wide = __int128;

struct MeshMeasure {
  // Six times the signed volume between the triangles and the lattice's origin, exact: the sum over
  // the tiles of a closed mesh is six times what it encloses, however it is cut.
  Wide volume6 = 0;
  double area2 = 0;         // twice the area, summed in the order of the triangles
  LatticePoint lo{}, hi{};  // of the corners of triangles; both zero where there are none
  bool empty = true;        // no triangle

  // Of both together. Areas are to be added in a fixed order.
  MeshMeasure& operator+=(const MeshMeasure& other) {
    if (other.empty) return *this;
    if (empty) return *this = other;
    volume6 += other.volume6;
    area2 += other.area2;
    for (std::size_t a = 0; a < 3; ++a) {
      lo[a] = std::min(lo[a], other.lo[a]);
      hi[a] = std::max(hi[a], other.hi[a]);
    }
    return *this;
  }
  friend bool operator==(const MeshMeasure&, const MeshMeasure&) = default;
};

}  // namespace voxweld
