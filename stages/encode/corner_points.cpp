#include "stages/encode/corner_points.h"

namespace voxweld {

DecodedMesh corner_points(const TileMesh& mesh, bool normals) {
  DecodedMesh out;
  if (!normals || mesh.corner_normals.empty()) {
    out.positions.reserve(mesh.positions.size());
    for (const LatticePoint& q : mesh.positions)
      out.positions.push_back(float_position(mesh.lattice, q));
    out.triangles = mesh.triangles;
    return out;
  }
  const CornerPoints points(mesh);
  out.positions.resize(points.count());
  out.normals.resize(points.count());
  points.each([&](std::uint32_t point, std::uint32_t vertex, CornerNormal normal) {
    const Vec3 n = normal.of(mesh.normals[vertex]);
    out.positions[point] = float_position(mesh.lattice, mesh.positions[vertex]);
    out.normals[point] = {static_cast<float>(n.x), static_cast<float>(n.y),
                          static_cast<float>(n.z)};
  });
  out.triangles.reserve(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    auto& corners = out.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k)
      corners[k] = points.of(mesh.triangles[t][k], mesh.corner_normals[t][k]);
  }
  return out;
}

}  // namespace voxweld
