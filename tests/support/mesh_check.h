// Plain checks of indexed triangle meshes, meant to be obviously right rather than fast. Triangles
// are three vertex indices, counter-clockwise seen from outside.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <ostream>
#include <span>
#include <vector>

#include "storage/types/box.h"

namespace voxweld::testing {

using Triangle = std::array<std::uint32_t, 3>;

struct DirectedEdge {
  std::uint32_t from = 0, to = 0;
  friend auto operator<=>(const DirectedEdge&, const DirectedEdge&) = default;
};

// A closed, consistently oriented mesh uses every directed edge once and its reverse once.
struct EdgeReport {
  std::vector<DirectedEdge> boundary;    // used, its reverse never; ascending
  std::vector<DirectedEdge> duplicated;  // used more than once; ascending, each listed once
  bool closed() const { return boundary.empty() && duplicated.empty(); }
};
EdgeReport check_edges(std::span<const Triangle> triangles);

// Vertices whose triangles do not form one closed ring or one open fan; ascending. Edges must be
// right (duplicated empty) for this to say all there is to say. Degenerate triangles, where two
// corners are equal, are left out here and below.
std::vector<std::uint32_t> nonmanifold_vertices(std::span<const Triangle> triangles);

// Indices of triangles with two equal corners.
std::vector<std::size_t> degenerate_triangles(std::span<const Triangle> triangles);

// V - E + F of the vertices and edges that triangles use.
std::int64_t euler_characteristic(std::span<const Triangle> triangles);

// Pieces of the mesh that share no vertex.
std::size_t connected_components(std::span<const Triangle> triangles);

// The Euler characteristic of each of them, ascending.
std::vector<std::int64_t> component_eulers(std::span<const Triangle> triangles);

// Positive when a closed mesh's triangles are counter-clockwise seen from outside.
double signed_volume(std::span<const Vec3> vertices, std::span<const Triangle> triangles);

// Vertices at exactly equal coordinates made one (0 and -0 are equal). Vertices keep the order of
// their first appearance.
struct WeldedMesh {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
};
WeldedMesh weld(std::span<const Vec3> vertices, std::span<const Triangle> triangles);

// All the counts at once, for one comparison in a test.
struct MeshSummary {
  std::size_t boundary_edges = 0;
  std::size_t duplicated_edges = 0;
  std::size_t nonmanifold_vertices = 0;
  std::size_t degenerate_triangles = 0;
  std::size_t components = 0;
  std::int64_t euler = 0;

  // Closed, oriented, 2-manifold, without degenerate triangles.
  bool sound() const {
    return boundary_edges + duplicated_edges + nonmanifold_vertices + degenerate_triangles == 0;
  }
  friend bool operator==(const MeshSummary&, const MeshSummary&) = default;
};
MeshSummary summarize(std::span<const Triangle> triangles);
std::ostream& operator<<(std::ostream& out, const MeshSummary& summary);

}  // namespace voxweld::testing
