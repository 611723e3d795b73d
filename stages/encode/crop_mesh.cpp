#include "stages/encode/crop_mesh.h"

#include <algorithm>

namespace voxweld {
namespace {

constexpr std::uint32_t unused = 0xffffffffu;

bool reaches_in(const TileMesh& mesh, const std::array<std::uint32_t, 3>& triangle, Vec3 lo,
                Vec3 hi) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto at = [&](std::size_t corner) {
      const LatticePoint& q = mesh.positions[triangle[corner]];
      return mesh.lattice.coordinate(axis, q[static_cast<std::size_t>(axis)]);
    };
    const auto [least, most] = std::minmax({at(0), at(1), at(2)});
    if (most < lo[axis] || least > hi[axis]) return false;
  }
  return true;
}

// One more vertex of the result, as that of `mesh` is.
void copy_vertex(const TileMesh& mesh, std::uint32_t v, TileMesh& out) {
  out.positions.push_back(mesh.positions[v]);
  if (!mesh.ids.empty()) out.ids.push_back(mesh.ids[v]);
  if (!mesh.aims.empty()) out.aims.push_back(mesh.aims[v]);
  if (!mesh.normals.empty()) out.normals.push_back(mesh.normals[v]);
}

}  // namespace

TileMesh cropped(const TileMesh& mesh, Vec3 lo, Vec3 hi) {
  TileMesh out;
  out.tile = mesh.tile;
  out.lattice = mesh.lattice;
  out.pairs = mesh.pairs;
  std::vector<std::uint32_t> place(mesh.positions.size(), unused);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!reaches_in(mesh, mesh.triangles[t], lo, hi)) continue;
    std::array<std::uint32_t, 3> corners = mesh.triangles[t];
    for (std::uint32_t& v : corners) {
      if (place[v] == unused) {
        place[v] = static_cast<std::uint32_t>(out.positions.size());
        copy_vertex(mesh, v, out);
      }
      v = place[v];
    }
    out.triangles.push_back(corners);
    if (!mesh.corner_normals.empty()) out.corner_normals.push_back(mesh.corner_normals[t]);
    if (!mesh.triangle_pairs.empty()) out.triangle_pairs.push_back(mesh.triangle_pairs[t]);
  }
  return out;
}

}  // namespace voxweld
