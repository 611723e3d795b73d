#include "stages/encode/pair_meshes.h"

#include <limits>

namespace voxweld {
namespace {

constexpr std::uint32_t unset = std::numeric_limits<std::uint32_t>::max();

}  // namespace

std::vector<TileMesh> split_by_pair(const TileMesh& mesh) {
  std::vector<std::vector<std::uint32_t>> triangles(mesh.pairs.size());
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i)
    triangles[mesh.triangle_pairs[i]].push_back(i);
  std::vector<std::uint32_t> number(mesh.positions.size(), unset);
  std::vector<TileMesh> parts(mesh.pairs.size());
  for (std::size_t p = 0; p < parts.size(); ++p) {
    TileMesh& part = parts[p];
    part.tile = mesh.tile;
    part.lattice = mesh.lattice;
    std::vector<std::uint32_t> vertices;
    for (const std::uint32_t t : triangles[p]) {
      auto& corners = part.triangles.emplace_back(mesh.triangles[t]);
      for (std::uint32_t& corner : corners) {
        if (number[corner] == unset) {
          number[corner] = static_cast<std::uint32_t>(vertices.size());
          vertices.push_back(corner);
        }
        corner = number[corner];
      }
      if (!mesh.corner_clusters.empty()) part.corner_clusters.push_back(mesh.corner_clusters[t]);
    }
    for (const std::uint32_t v : vertices) {
      part.positions.push_back(mesh.positions[v]);
      part.ids.push_back(mesh.ids[v]);
      if (!mesh.normals.empty()) part.normals.push_back(mesh.normals[v]);
      number[v] = unset;
    }
  }
  return parts;
}

}  // namespace voxweld
