// Distances to meshes, through a grid of cubes; made to be plain, for tests.
#pragma once

#include <limits>
#include <unordered_map>

#include "tests/support/triangle_meshes.h"

namespace voxweld::testing {

class NearestTriangle {
 public:
  NearestTriangle(const TriangleMesh& mesh, double cube) : mesh_(mesh), cube_(cube) {
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      const auto& t = mesh.triangles[i];
      Vec3 lo = mesh.vertices[t[0]], hi = lo;
      for (const std::uint32_t corner : t)
        for (int a = 0; a < 3; ++a) {
          lo[a] = std::min(lo[a], mesh.vertices[corner][a]);
          hi[a] = std::max(hi[a], mesh.vertices[corner][a]);
        }
      each_index({cube_at(lo), cube_at(hi) + splat(1)},
                 [&](Index3 at) { cubes_[key(at)].push_back(i); });
    }
  }

  // In the mesh's own units; infinite beyond `reach` cubes.
  double distance_to(Vec3 p, int reach = 64) const {
    double least = std::numeric_limits<double>::infinity();
    const Index3 home = cube_at(p);
    for (int r = 0; r <= reach && least > (r - 1) * cube_; ++r)
      each_index({home - splat(r), home + splat(r + 1)}, [&](Index3 at) {
        const Index3 d = at - home;
        if (std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}) != r) return;
        const auto found = cubes_.find(key(at));
        if (found == cubes_.end()) return;
        for (const std::uint32_t i : found->second) {
          const auto& t = mesh_.triangles[i];
          least = std::min(
              least, distance(p, mesh_.vertices[t[0]], mesh_.vertices[t[1]], mesh_.vertices[t[2]]));
        }
      });
    return least;
  }

 private:
  Index3 cube_at(Vec3 p) const {
    Index3 at;
    for (int a = 0; a < 3; ++a) at[a] = static_cast<std::int64_t>(std::floor(p[a] / cube_));
    return at;
  }
  static std::int64_t key(Index3 at) { return (at.z * 1048583 + at.y) * 1048573 + at.x; }

  TriangleMesh mesh_;
  double cube_;
  std::unordered_map<std::int64_t, std::vector<std::uint32_t>> cubes_;
};

// The edges at which the mesh turns by more than `degrees`, each as a triangle without area.
inline TriangleMesh sharp_edges(const TriangleMesh& mesh, double degrees) {
  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  const auto edge_of = [](const auto& t, std::size_t i) -> Edge {
    return std::minmax(t[i], t[(i + 1) % 3]);
  };
  std::map<Edge, std::vector<Vec3>> normals;
  std::vector<std::size_t> slivers;
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    const auto& t = mesh.triangles[k];
    const Vec3 a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
    const Vec3 n = cross(b - a, c - a);
    const double length = std::sqrt(dot(n, n));
    // Of one that is all but a line the normal says nothing.
    const double longest = std::max({dot(b - a, b - a), dot(c - b, c - b), dot(a - c, a - c)});
    if (length <= 1e-4 * longest) {
      slivers.push_back(k);
      continue;
    }
    for (std::size_t i = 0; i < 3; ++i) normals[edge_of(t, i)].push_back(n * (1 / length));
  }
  // Across a sliver its neighbours meet: where those differ its edges are sharp.
  std::map<Edge, std::vector<Vec3>> across;
  for (const std::size_t k : slivers)
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        const auto found = normals.find(edge_of(mesh.triangles[k], j));
        if (i == j || found == normals.end()) continue;
        auto& here = across[edge_of(mesh.triangles[k], i)];
        here.insert(here.end(), found->second.begin(), found->second.end());
      }
  TriangleMesh edges{mesh.vertices, {}};
  const double least = std::cos(degrees * 3.14159265358979 / 180);
  const auto add = [&](const Edge& edge) {
    edges.triangles.push_back({edge.first, edge.second, edge.second});
  };
  for (const auto& [edge, n] : normals)
    if (n.size() == 2 && dot(n[0], n[1]) < least) add(edge);
  for (const auto& [edge, others] : across) {
    const auto own = normals.find(edge);
    if (own == normals.end()) continue;
    const Vec3 n = own->second.front();
    if (std::ranges::any_of(others, [&](const Vec3& o) { return dot(n, o) < least; })) add(edge);
  }
  return edges;
}

}  // namespace voxweld::testing
