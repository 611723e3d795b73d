#include "tests/support/mesh_check.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace voxweld::testing {
namespace {

bool degenerate(const Triangle& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

std::map<DirectedEdge, int> count_edges(std::span<const Triangle> triangles) {
  std::map<DirectedEdge, int> uses;
  for (const Triangle& t : triangles)
    if (!degenerate(t))
      for (std::size_t i = 0; i < 3; ++i) ++uses[{t[i], t[(i + 1) % 3]}];
  return uses;
}

// The edges opposite to a vertex, one a triangle around it: in a manifold they follow one another
// in a single cycle or a single path.
bool single_cycle_or_path(const std::vector<DirectedEdge>& links) {
  std::map<std::uint32_t, std::uint32_t> next;
  std::set<std::uint32_t> targets;
  for (const DirectedEdge& link : links) {
    if (!next.emplace(link.from, link.to).second) return false;
    if (!targets.insert(link.to).second) return false;
  }
  std::uint32_t start = links.front().from;
  for (const DirectedEdge& link : links)
    if (!targets.contains(link.from)) start = link.from;  // the open end of a fan
  std::size_t steps = 0;
  for (auto at = next.find(start); at != next.end(); at = next.find(at->second)) {
    ++steps;
    if (at->second == start) break;
  }
  return steps == links.size();
}

}  // namespace

EdgeReport check_edges(std::span<const Triangle> triangles) {
  const auto uses = count_edges(triangles);
  EdgeReport report;
  for (const auto& [edge, count] : uses) {
    if (count > 1) report.duplicated.push_back(edge);
    if (!uses.contains({edge.to, edge.from})) report.boundary.push_back(edge);
  }
  return report;
}

std::vector<std::uint32_t> nonmanifold_vertices(std::span<const Triangle> triangles) {
  std::map<std::uint32_t, std::vector<DirectedEdge>> links;
  for (const Triangle& t : triangles)
    if (!degenerate(t))
      for (std::size_t i = 0; i < 3; ++i) links[t[i]].push_back({t[(i + 1) % 3], t[(i + 2) % 3]});
  std::vector<std::uint32_t> bad;
  for (const auto& [vertex, edges] : links)
    if (!single_cycle_or_path(edges)) bad.push_back(vertex);
  return bad;
}

std::vector<std::size_t> degenerate_triangles(std::span<const Triangle> triangles) {
  std::vector<std::size_t> bad;
  for (std::size_t i = 0; i < triangles.size(); ++i)
    if (degenerate(triangles[i])) bad.push_back(i);
  return bad;
}

std::int64_t euler_characteristic(std::span<const Triangle> triangles) {
  std::set<std::uint32_t> vertices;
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  std::int64_t faces = 0;
  for (const Triangle& t : triangles) {
    if (degenerate(t)) continue;
    ++faces;
    vertices.insert(t.begin(), t.end());
    for (std::size_t i = 0; i < 3; ++i) edges.insert(std::minmax(t[i], t[(i + 1) % 3]));
  }
  return static_cast<std::int64_t>(vertices.size()) - static_cast<std::int64_t>(edges.size()) +
         faces;
}

std::size_t connected_components(std::span<const Triangle> triangles) {
  std::map<std::uint32_t, std::set<std::uint32_t>> neighbours;
  for (const Triangle& t : triangles)
    if (!degenerate(t))
      for (const std::uint32_t a : t) neighbours[a].insert(t.begin(), t.end());
  std::size_t components = 0;
  std::set<std::uint32_t> seen;
  for (const auto& [start, ignored] : neighbours) {
    if (!seen.insert(start).second) continue;
    ++components;
    std::vector<std::uint32_t> pending = {start};
    while (!pending.empty()) {
      const std::uint32_t at = pending.back();
      pending.pop_back();
      for (const std::uint32_t other : neighbours.at(at))
        if (seen.insert(other).second) pending.push_back(other);
    }
  }
  return components;
}

std::vector<std::int64_t> component_eulers(std::span<const Triangle> triangles) {
  std::map<std::uint32_t, std::uint32_t> parent;
  const auto root = [&](std::uint32_t v) {
    while (parent.at(v) != v) v = parent[v] = parent.at(parent.at(v));
    return v;
  };
  for (const Triangle& t : triangles) {
    for (const std::uint32_t v : t) parent.try_emplace(v, v);
    for (std::size_t k = 1; k < 3; ++k) {
      const std::uint32_t a = root(t[0]), b = root(t[k]);
      parent[std::max(a, b)] = std::min(a, b);
    }
  }
  std::map<std::uint32_t, std::vector<Triangle>> components;
  for (const Triangle& t : triangles) components[root(t[0])].push_back(t);
  std::vector<std::int64_t> eulers;
  eulers.reserve(components.size());
  for (const auto& [first, component] : components)
    eulers.push_back(euler_characteristic(component));
  std::sort(eulers.begin(), eulers.end());
  return eulers;
}

double signed_volume(std::span<const Vec3> vertices, std::span<const Triangle> triangles) {
  double sum = 0;
  for (const Triangle& t : triangles)
    sum += dot(vertices[t[0]], cross(vertices[t[1]], vertices[t[2]]));
  return sum / 6;
}

WeldedMesh weld(std::span<const Vec3> vertices, std::span<const Triangle> triangles) {
  WeldedMesh mesh;
  std::map<std::array<double, 3>, std::uint32_t> known;
  std::vector<std::uint32_t> renamed;
  for (const Vec3& v : vertices) {
    const auto [at, is_new] =
        known.emplace(std::array{v.x, v.y, v.z}, static_cast<std::uint32_t>(mesh.vertices.size()));
    if (is_new) mesh.vertices.push_back(v);
    renamed.push_back(at->second);
  }
  for (const Triangle& t : triangles)
    mesh.triangles.push_back({renamed[t[0]], renamed[t[1]], renamed[t[2]]});
  return mesh;
}

MeshSummary summarize(std::span<const Triangle> triangles) {
  const EdgeReport edges = check_edges(triangles);
  return {.boundary_edges = edges.boundary.size(),
          .duplicated_edges = edges.duplicated.size(),
          .nonmanifold_vertices = nonmanifold_vertices(triangles).size(),
          .degenerate_triangles = degenerate_triangles(triangles).size(),
          .components = connected_components(triangles),
          .euler = euler_characteristic(triangles)};
}

std::ostream& operator<<(std::ostream& out, const MeshSummary& s) {
  return out << "boundary edges " << s.boundary_edges << ", duplicated edges " << s.duplicated_edges
             << ", non-manifold vertices " << s.nonmanifold_vertices << ", degenerate triangles "
             << s.degenerate_triangles << ", components " << s.components << ", Euler " << s.euler;
}

}  // namespace voxweld::testing
