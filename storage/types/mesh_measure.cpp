#include "storage/types/mesh_measure.h"

#include <algorithm>

namespace voxweld {

MeshMeasure& MeshMeasure::operator+=(const MeshMeasure& other) {
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

}  // namespace voxweld
