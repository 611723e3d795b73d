#include "stages/encode/adjacency.h"

#include <algorithm>

namespace voxweld {
namespace {

// Calls copy(v, triangle corner to point to the copy ...) for each fan of v but the first.
template <class Copy>
std::uint64_t for_each_surplus_fan(std::vector<Triangle>& triangles, std::size_t vertices,
                                   Copy copy) {
  struct Surplus {
    std::uint32_t vertex;
    std::vector<std::uint32_t> half_edges;
  };
  std::vector<Surplus> surplus;
  const Adjacency adjacency(std::span<const Triangle>(triangles), vertices);
  std::vector<Fan> fans;
  for (std::uint32_t v = 0; v < vertices; ++v) {
    adjacency.fans(v, fans);
    for (std::size_t i = 1; i < fans.size(); ++i)
      surplus.push_back({v, std::move(fans[i].half_edges)});
  }
  for (const Surplus& s : surplus) {
    const std::uint32_t duplicate = copy(s.vertex);
    for (const std::uint32_t h : s.half_edges) triangles[h / 3][h % 3] = duplicate;
  }
  return surplus.size();
}

}  // namespace

Adjacency::Adjacency(std::span<const Triangle> triangles, std::size_t vertices)
    : triangles_(triangles) {
  sort_by_origin(vertices);
  match();
}

void Adjacency::sort_by_origin(std::size_t vertices) {
  first_.assign(vertices + 1, 0);
  for (const Triangle& t : triangles_)
    for (const std::uint32_t v : t) ++first_[v + 1];
  for (std::size_t v = 0; v < vertices; ++v) first_[v + 1] += first_[v];
  half_edges_.resize(3 * triangles_.size());
  std::vector<std::uint32_t> at(first_.begin(), first_.end() - 1);
  for (std::uint32_t h = 0; h < half_edges_.size(); ++h) half_edges_[at[from(h)]++] = h;
}

void Adjacency::match() {
  opposite_.assign(half_edges_.size(), boundary);
  for (std::uint32_t h = 0; h < half_edges_.size(); ++h) {
    const std::uint32_t a = from(h), b = to(h);
    std::uint32_t same = 0, reverse = 0;
    for (const std::uint32_t other : outgoing(a)) same += to(other) == b;
    for (const std::uint32_t other : outgoing(b)) {
      if (to(other) != a) continue;
      ++reverse;
      opposite_[h] = other;
    }
    if (same > 1 || reverse > 1 || a == b) opposite_[h] = complex;
  }
}

Fan Adjacency::walk(std::uint32_t start) const {
  Fan fan;
  // Back (clockwise) to where the fan begins, or once around.
  std::uint32_t h = start;
  while (opposite_[h] < complex) {
    h = next(opposite_[h]);
    if (h == start) {
      fan.closed = true;
      break;
    }
  }
  fan.from = to(h);
  const std::uint32_t first = h;
  for (;;) {
    fan.half_edges.push_back(h);
    const std::uint32_t incoming = previous(h);
    fan.to = from(incoming);
    if (opposite_[incoming] >= complex || opposite_[incoming] == first) return fan;
    h = opposite_[incoming];
  }
}

void Adjacency::fans(std::uint32_t v, std::vector<Fan>& out) const {
  out.clear();
  const std::span<const std::uint32_t> around = outgoing(v);  // ascending
  std::vector<bool> visited(around.size(), false);
  for (std::size_t i = 0; i < around.size(); ++i) {
    if (visited[i]) continue;
    out.push_back(walk(around[i]));
    for (const std::uint32_t h : out.back().half_edges) {
      const auto at = std::lower_bound(around.begin(), around.end(), h) - around.begin();
      visited[static_cast<std::size_t>(at)] = true;
    }
  }
}

std::uint64_t split_fans(TileMesh& mesh) {
  return for_each_surplus_fan(mesh.triangles, mesh.positions.size(), [&](std::uint32_t v) {
    mesh.positions.push_back(mesh.positions[v]);
    if (!mesh.ids.empty()) mesh.ids.push_back(mesh.ids[v]);
    if (!mesh.normals.empty()) mesh.normals.push_back(mesh.normals[v]);
    return static_cast<std::uint32_t>(mesh.positions.size() - 1);
  });
}

std::uint64_t split_fans(LatticeMesh& mesh) {
  return for_each_surplus_fan(mesh.triangles, mesh.positions.size(), [&](std::uint32_t v) {
    mesh.positions.push_back(mesh.positions[v]);
    return static_cast<std::uint32_t>(mesh.positions.size() - 1);
  });
}

}  // namespace voxweld
