#include "tests/paper/surface_net.h"

#include <algorithm>

namespace voxweld::paper {
namespace {

constexpr std::uint32_t none = 0xffffffffu;

double square_distance(Vec3 a, Vec3 b) {
  return dot(a - b, a - b);
}

}  // namespace

// Cell c has samples c - 1 and c on each axis: 0 .. size.
SurfaceNet::SurfaceNet(Index3 size, const std::function<bool(Index3)>& inside)
    : cells_(size + splat(1)),
      vertex_of_cell_(static_cast<std::size_t>(cells_.x * cells_.y * cells_.z), none) {
  const Box3 samples{{}, size};
  find_quads(size, [&](Index3 s) { return samples.contains(s) && inside(s); });
  neighbours_.resize(vertices_.size());
  for (const auto& quad : quads_)
    for (std::size_t k = 0; k < 4; ++k) {
      neighbours_[quad[k]].push_back(quad[(k + 1) % 4]);
      neighbours_[quad[(k + 1) % 4]].push_back(quad[k]);
    }
  for (auto& list : neighbours_) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
}

std::uint32_t SurfaceNet::vertex_of(Index3 cell) {
  std::uint32_t& vertex =
      vertex_of_cell_[static_cast<std::size_t>((cell.z * cells_.y + cell.y) * cells_.x + cell.x)];
  if (vertex != none) return vertex;
  vertex = static_cast<std::uint32_t>(vertices_.size());
  const Vec3 centre{static_cast<double>(cell.x) - 0.5, static_cast<double>(cell.y) - 0.5,
                    static_cast<double>(cell.z) - 0.5};
  centres_.push_back(centre);
  vertices_.push_back(centre);
  midpoint_sums_.emplace_back();
  midpoint_counts_.push_back(0);
  return vertex;
}

void SurfaceNet::find_quads(Index3 size, const std::function<bool(Index3)>& inside) {
  for (int axis = 0; axis < 3; ++axis) {
    const int b = (axis + 1) % 3, c = (axis + 2) % 3;
    Index3 along, to_b, to_c;
    along[axis] = to_b[b] = to_c[c] = 1;
    for (Index3 s{-1, -1, -1}; s.z < size.z; ++s.z)
      for (s.y = -1; s.y < size.y; ++s.y)
        for (s.x = -1; s.x < size.x; ++s.x) {
          const bool low = inside(s);
          if (low == inside(s + along)) continue;
          // The cells around the edge from s along the axis, counter-clockwise seen from its end.
          const Index3 first = s + along;
          std::array<std::uint32_t, 4> quad = {vertex_of(first), vertex_of(first + to_b),
                                               vertex_of(first + to_b + to_c),
                                               vertex_of(first + to_c)};
          Vec3 middle{static_cast<double>(s.x), static_cast<double>(s.y), static_cast<double>(s.z)};
          middle[axis] += 0.5;
          for (const std::uint32_t v : quad) {
            midpoint_sums_[v] = midpoint_sums_[v] + middle;
            ++midpoint_counts_[v];
          }
          if (!low) std::swap(quad[1], quad[3]);
          quads_.push_back(quad);
        }
  }
}

void SurfaceNet::relax(const Relaxation& relaxation) {
  std::vector<Vec3> next(vertices_.size());
  for (int i = 0; i < relaxation.iterations; ++i) {
    for (std::size_t v = 0; v < vertices_.size(); ++v) {
      Vec3 mean;
      for (const std::uint32_t other : neighbours_[v]) mean = mean + vertices_[other];
      mean = mean * (1.0 / static_cast<double>(neighbours_[v].size()));
      next[v] = vertices_[v] + (mean - vertices_[v]) * relaxation.factor;
      for (int a = 0; a < 3; ++a)
        next[v][a] = std::clamp(next[v][a], centres_[v][a] - relaxation.reach,
                                centres_[v][a] + relaxation.reach);
    }
    std::swap(vertices_, next);
  }
}

void SurfaceNet::to_means_of_midpoints() {
  for (std::size_t v = 0; v < vertices_.size(); ++v)
    vertices_[v] = midpoint_sums_[v] * (1.0 / midpoint_counts_[v]);
}

TriangleMesh SurfaceNet::mesh() const {
  TriangleMesh mesh{vertices_, {}};
  for (const auto& [a, b, c, d] : quads_) {
    const bool first =
        square_distance(vertices_[a], vertices_[c]) <= square_distance(vertices_[b], vertices_[d]);
    mesh.triangles.push_back(first ? std::array{a, b, c} : std::array{b, c, d});
    mesh.triangles.push_back(first ? std::array{a, c, d} : std::array{b, d, a});
  }
  return mesh;
}

}  // namespace voxweld::paper
