// Points spread over a mesh.
#pragma once

#include <vector>

#include "pipeline/phantom/lattice_fields.h"
#include "storage/types/triangle_mesh.h"
#include "tests/support/mesh_distance.h"

namespace voxweld::testing {

// `count` points, as many on a piece of the mesh as its area's share of the whole. The same for the
// same mesh. None where it has no area.
inline std::vector<Vec3> points_by_area(const TriangleMesh& mesh, std::size_t count) {
  const auto corner = [&](const auto& t, std::size_t i) { return mesh.vertices[t[i]]; };
  double area = 0;
  for (const auto& t : mesh.triangles) area += area_of(corner(t, 0), corner(t, 1), corner(t, 2));
  std::vector<Vec3> points;
  if (area <= 0) return points;
  // One for each of `count` equal parts of the area, in the middle of its part; in its triangle
  // where a hash of its number says.
  const double part = area / static_cast<double>(count);
  double passed = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = corner(t, 0), b = corner(t, 1), c = corner(t, 2);
    passed += area_of(a, b, c);
    while ((static_cast<double>(points.size()) + 0.5) * part < passed && points.size() < count) {
      const std::uint64_t number = points.size();
      double u = uniform(mix_bits(1, number)), v = uniform(mix_bits(2, number));
      if (u + v > 1) u = 1 - u, v = 1 - v;
      points.push_back(a + (b - a) * u + (c - a) * v);
    }
  }
  return points;
}

}  // namespace voxweld::testing
