#include "stages/encode/mesh_measure.h"

#include <algorithm>
#include <cmath>

#include "stages/exact/orientation.h"

namespace voxweld {

MeshMeasure measure(std::span<const LatticePoint> positions,
                    std::span<const std::array<std::uint32_t, 3>> triangles) {
  MeshMeasure m;
  if (triangles.empty()) return m;
  m.empty = false;
  m.lo = m.hi = positions[triangles[0][0]];
  for (const auto& t : triangles) {
    const Index3 p = lattice_vector({}, positions[t[0]]);
    const Index3 normal = exact_normal(positions[t[0]], positions[t[1]], positions[t[2]]);
    double squared = 0;
    for (int a = 0; a < 3; ++a) {
      m.volume6 += static_cast<Wide>(p[a]) * normal[a];
      squared += static_cast<double>(normal[a]) * static_cast<double>(normal[a]);
    }
    m.area2 += std::sqrt(squared);
    for (const std::uint32_t corner : t)
      for (std::size_t a = 0; a < 3; ++a) {
        m.lo[a] = std::min(m.lo[a], positions[corner][a]);
        m.hi[a] = std::max(m.hi[a], positions[corner][a]);
      }
  }
  return m;
}

double enclosed_volume(const MeshMeasure& measure, const OutputLattice& lattice) {
  return static_cast<double>(measure.volume6) / 6 * lattice.step * lattice.step * lattice.step;
}

double surface_area(const MeshMeasure& measure, const OutputLattice& lattice) {
  return measure.area2 / 2 * lattice.step * lattice.step;
}

}  // namespace voxweld
