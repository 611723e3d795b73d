#include "stages/solids/mesh_boundary.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace voxweld {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;  // the lower vertex first

std::vector<Edge> odd_edges(const TriangleMesh& mesh) {
  std::vector<Edge> all;
  all.reserve(3 * mesh.triangles.size());
  for (const auto& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) all.push_back(std::minmax(t[i], t[(i + 1) % 3]));
  std::sort(all.begin(), all.end());
  std::vector<Edge> odd;
  for (const Edge& edge : all) {
    if (!odd.empty() && odd.back() == edge)
      odd.pop_back();
    else
      odd.push_back(edge);
  }
  return odd;
}

// What hangs together, by the lowest vertex of each (union by path halving).
class Groups {
 public:
  std::uint32_t of(std::uint32_t vertex) {
    parent_.try_emplace(vertex, vertex);
    while (parent_[vertex] != vertex) vertex = parent_[vertex] = parent_[parent_[vertex]];
    return vertex;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    const auto [low, high] = std::minmax({of(a), of(b)});
    parent_[high] = low;
  }

 private:
  std::map<std::uint32_t, std::uint32_t> parent_;
};

struct Extent {
  std::uint64_t edges = 0;
  Vec3 lo, hi;

  void add(Vec3 p, bool first) {
    lo = first ? p : min(lo, p);
    hi = first ? p : max(hi, p);
  }
};

}  // namespace

MeshBoundary boundary_of(const TriangleMesh& mesh) {
  return boundary_of(odd_edges(mesh), mesh.vertices);
}

MeshBoundary boundary_of(std::span<const Edge> edges, std::span<const Vec3> places) {
  Groups groups;
  for (const Edge& edge : edges) groups.join(edge.first, edge.second);
  std::map<std::uint32_t, Extent> extents;
  for (const Edge& edge : edges) {
    Extent& extent = extents[groups.of(edge.first)];
    extent.add(places[edge.first], extent.edges == 0);
    extent.add(places[edge.second], false);
    ++extent.edges;
  }
  MeshBoundary boundary{edges.size(), {}};
  for (const auto& [vertex, extent] : extents) {
    const Vec3 diagonal = extent.hi - extent.lo;
    boundary.holes.push_back(
        {extent.edges, (extent.lo + extent.hi) * 0.5, std::sqrt(dot(diagonal, diagonal))});
  }
  std::stable_sort(boundary.holes.begin(), boundary.holes.end(),
                   [](const MeshHole& a, const MeshHole& b) { return a.size > b.size; });
  return boundary;
}

Bounds bounds_of(const TriangleMesh& mesh) {
  const Vec3 first = mesh.vertices[mesh.triangles.at(0)[0]];
  Bounds bounds{first, first};
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t corner : t) {
      bounds.lo = min(bounds.lo, mesh.vertices[corner]);
      bounds.hi = max(bounds.hi, mesh.vertices[corner]);
    }
  return bounds;
}

double signed_volume(const TriangleMesh& mesh) {
  if (mesh.vertices.empty()) return 0;
  // From a corner of the mesh, so that places far from 0 cancel nothing.
  const Vec3 from = mesh.vertices[0];
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += dot(mesh.vertices[a] - from, cross(mesh.vertices[b] - from, mesh.vertices[c] - from));
  return sum / 6;
}

}  // namespace voxweld
