// The edges at which a mesh turns.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "tests/support/triangle_meshes.h"

namespace voxweld::testing {

// Finds sharp_edges() below. Flat sorted lists in place of maps: meshes have millions of edges.
class SharpEdgeSearch {
 public:
  using Edge = std::pair<std::uint32_t, std::uint32_t>;

  SharpEdgeSearch(const TriangleMesh& mesh, double degrees)
      : mesh_(mesh), least_(std::cos(degrees * std::numbers::pi / 180)) {
    for (std::uint32_t k = 0; k < mesh.triangles.size(); ++k) {
      normals_.push_back(normal_of(k));
      if (sliver(k))
        slivers_.push_back(k);
      else
        for (std::size_t i = 0; i < 3; ++i) sides_.push_back({edge_of(k, i), k});
    }
    std::ranges::sort(sides_);
  }

  std::vector<Edge> found() const {
    std::vector<Edge> edges;
    for (std::size_t i = 0, end = 0; i < sides_.size(); i = end) {
      while (end < sides_.size() && sides_[end].edge == sides_[i].edge) ++end;
      if (end - i == 2 && turns(normal(sides_[i]), normal(sides_[i + 1])))
        edges.push_back(sides_[i].edge);
    }
    add_slivers(edges);
    return edges;
  }

 private:
  struct Side {
    Edge edge;
    std::uint32_t triangle;
    friend auto operator<=>(const Side&, const Side&) = default;
  };

  Edge edge_of(std::uint32_t triangle, std::size_t i) const {
    const auto& t = mesh_.triangles[triangle];
    return std::minmax(t[i], t[(i + 1) % 3]);
  }
  // Zero of one that is all but a line, whose normal says nothing.
  Vec3 normal_of(std::uint32_t triangle) const {
    const auto& t = mesh_.triangles[triangle];
    const Vec3 a = mesh_.vertices[t[0]], b = mesh_.vertices[t[1]], c = mesh_.vertices[t[2]];
    const Vec3 n = cross(b - a, c - a);
    const double length = std::sqrt(dot(n, n));
    const double longest = std::max({dot(b - a, b - a), dot(c - b, c - b), dot(a - c, a - c)});
    return length <= 1e-4 * longest ? Vec3{} : n * (1 / length);
  }
  bool sliver(std::uint32_t triangle) const { return normals_[triangle] == Vec3{}; }
  Vec3 normal(const Side& side) const { return normals_[side.triangle]; }
  bool turns(Vec3 a, Vec3 b) const { return dot(a, b) < least_; }

  std::span<const Side> sides_of(const Edge& edge) const {
    const auto before = [](const Side& side, const Edge& e) { return side.edge < e; };
    const auto behind = [](const Edge& e, const Side& side) { return e < side.edge; };
    return {std::lower_bound(sides_.begin(), sides_.end(), edge, before),
            std::upper_bound(sides_.begin(), sides_.end(), edge, behind)};
  }

  // Across a sliver its neighbours meet: where those differ its edges are sharp.
  void add_slivers(std::vector<Edge>& edges) const {
    std::vector<Edge> sharp;
    for (const std::uint32_t k : slivers_)
      for (std::size_t i = 0; i < 3; ++i) {
        const auto own = sides_of(edge_of(k, i));
        if (own.empty()) continue;
        for (std::size_t j = 0; j < 3; ++j)
          if (i != j && std::ranges::any_of(sides_of(edge_of(k, j)), [&](const Side& other) {
                return turns(normal(own.front()), normal(other));
              }))
            sharp.push_back(edge_of(k, i));
      }
    std::ranges::sort(sharp);
    edges.insert(edges.end(), sharp.begin(), std::unique(sharp.begin(), sharp.end()));
  }

  const TriangleMesh& mesh_;
  double least_;
  std::vector<Vec3> normals_;
  std::vector<std::uint32_t> slivers_;
  std::vector<Side> sides_;  // of all triangles but slivers; ascending
};

// The edges at which the mesh turns by more than `degrees`, each as a triangle without area.
inline TriangleMesh sharp_edges(const TriangleMesh& mesh, double degrees) {
  TriangleMesh edges{mesh.vertices, {}};
  for (const auto& [from, to] : SharpEdgeSearch(mesh, degrees).found())
    edges.triangles.push_back({from, to, to});
  return edges;
}

}  // namespace voxweld::testing
