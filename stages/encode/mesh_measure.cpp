#include "stages/encode/mesh_measure.h"

#include <algorithm>
#include <cmath>

namespace voxweld {
namespace {

using Wide3 = std::array<std::int64_t, 3>;

Wide3 wide(const LatticePoint& q) {
  return {q[0], q[1], q[2]};
}
Wide3 difference(const Wide3& a, const Wide3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
// Coordinates have 22 bits, products 44: exact.
Wide3 cross_product(const Wide3& a, const Wide3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

}  // namespace

MeshMeasure measure(std::span<const LatticePoint> positions,
                    std::span<const std::array<std::uint32_t, 3>> triangles) {
  MeshMeasure m;
  if (triangles.empty()) return m;
  m.empty = false;
  m.lo = m.hi = positions[triangles[0][0]];
  for (const auto& t : triangles) {
    const Wide3 p = wide(positions[t[0]]), q = wide(positions[t[1]]), r = wide(positions[t[2]]);
    const Wide3 normal = cross_product(difference(q, p), difference(r, p));
    for (std::size_t a = 0; a < 3; ++a) m.volume6 += static_cast<Wide>(p[a]) * normal[a];
    double squared = 0;
    for (const std::int64_t n : normal) squared += static_cast<double>(n) * static_cast<double>(n);
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
