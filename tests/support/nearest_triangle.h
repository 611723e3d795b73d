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
      each_cube({cube_at(lo), cube_at(hi) + splat(1)},
                [&](Index3 at) { cubes_[key(at)].push_back(i); });
    }
  }

  // In the mesh's own units; infinite beyond `reach` cubes.
  double distance_to(Vec3 p, int reach = 64) const {
    double least = std::numeric_limits<double>::infinity();
    const Index3 home = cube_at(p);
    for (int r = 0; r <= reach && least > (r - 1) * cube_; ++r)
      each_cube({home - splat(r), home + splat(r + 1)}, [&](Index3 at) {
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
  template <class F>
  static void each_cube(const Box3& box, F&& f) {
    for (std::int64_t z = box.lo.z; z < box.hi.z; ++z)
      for (std::int64_t y = box.lo.y; y < box.hi.y; ++y)
        for (std::int64_t x = box.lo.x; x < box.hi.x; ++x) f(Index3{x, y, z});
  }
  static std::int64_t key(Index3 at) { return (at.z * 1048583 + at.y) * 1048573 + at.x; }

  TriangleMesh mesh_;
  double cube_;
  std::unordered_map<std::int64_t, std::vector<std::uint32_t>> cubes_;
};

// The edges at which the mesh turns by more than `degrees`, each as a triangle without area.
inline TriangleMesh sharp_edges(const TriangleMesh& mesh, double degrees) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Vec3>> normals;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]];
    Vec3 n = cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a);
    const double length = std::sqrt(dot(n, n));
    if (length == 0) continue;
    for (std::size_t i = 0; i < 3; ++i)
      normals[std::minmax(t[i], t[(i + 1) % 3])].push_back(n * (1 / length));
  }
  TriangleMesh edges{mesh.vertices, {}};
  const double least = std::cos(degrees * 3.14159265358979 / 180);
  for (const auto& [edge, n] : normals)
    if (n.size() == 2 && dot(n[0], n[1]) < least)
      edges.triangles.push_back({edge.first, edge.second, edge.second});
  return edges;
}

}  // namespace voxweld::testing
