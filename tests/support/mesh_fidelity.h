// How near a mesh that came out lies to the one that went in, in cells.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "tests/support/sharp_edges.h"
#include "tests/support/triangle_tree.h"

namespace voxweld::testing {

struct Spread {
  double sum = 0, most = 0;
  std::size_t count = 0, near = 0;  // near: within the limit
  void add(double value, double limit) {
    sum += value;
    most = std::max(most, value);
    ++count;
    near += value <= limit ? 1 : 0;
  }
  double mean() const { return count > 0 ? sum / static_cast<double>(count) : 0; }
  double share() const {
    return count > 0 ? static_cast<double>(near) / static_cast<double>(count) : 1;
  }
};

// Of points from a mesh, in cells; the near ones are within a tenth of one.
inline Spread distances(const std::vector<Vec3>& points, const TriangleMesh& mesh, double cell) {
  const TriangleTree tree(mesh);
  Spread spread;
  for (const Vec3& p : points) spread.add(tree.distance_to(p) / cell, 0.1);
  return spread;
}

// Points of edges, half a cell apart. edges: as sharp_edges() gives them.
inline std::vector<Vec3> points_on(const TriangleMesh& edges, double cell) {
  std::vector<Vec3> points;
  for (const auto& t : edges.triangles) {
    const Vec3 a = edges.vertices[t[0]], b = edges.vertices[t[1]];
    const int count = 1 + static_cast<int>(std::sqrt(dot(b - a, b - a)) / (0.5 * cell));
    for (int i = 0; i < count; ++i) points.push_back(a + (b - a) * ((i + 0.5) / count));
  }
  return points;
}

// Edges at which the surface turns right around: of triangles that lie on one another.
inline std::size_t folded_edges(const TriangleMesh& mesh) {
  return sharp_edges(mesh, 150).triangles.size();
}

// Decoded meshes put together again: what lies at one place is one vertex, as those are that have
// several normals or stand in several tiles.
class MeshWelder {
 public:
  template <class Decoded>
  void add(const Decoded& decoded, Vec3 by = {}) {
    std::vector<std::uint32_t> becomes;
    for (const auto& p : decoded.positions) {
      const Vec3 v = Vec3{p[0], p[1], p[2]} + by;
      const auto [found, added] =
          known_.try_emplace({v.x, v.y, v.z}, static_cast<std::uint32_t>(mesh_.vertices.size()));
      if (added) mesh_.vertices.push_back(v);
      becomes.push_back(found->second);
    }
    for (const auto& t : decoded.triangles)
      mesh_.triangles.push_back({becomes[t[0]], becomes[t[1]], becomes[t[2]]});
  }
  const TriangleMesh& mesh() const { return mesh_; }

 private:
  TriangleMesh mesh_;
  std::map<std::array<double, 3>, std::uint32_t> known_;
};

}  // namespace voxweld::testing
