// What is wrong with a mesh of any size: counts by sorted lists and exact tests.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "storage/types/output_lattice.h"
#include "storage/types/triangle_mesh.h"

namespace voxweld::testing {

// Vertices at exactly equal coordinates made one; those of no triangle stay. Triangles keep their
// order and may have a corner twice.
TriangleMesh welded(const TriangleMesh& mesh);

// Edges and vertices leave out triangles that have a corner twice.
struct MeshDefects {
  std::uint64_t boundary_edges = 0;     // of one triangle
  std::uint64_t nonmanifold_edges = 0;  // of three or more, or two that run along it the same way
  std::uint64_t nonmanifold_vertices = 0;  // on no such edge, yet no single ring or fan around them
  std::uint64_t degenerate = 0;            // triangles without an area
};
// Precondition: a welded mesh.
MeshDefects find_defects(const TriangleMesh& mesh);

// With positions[i] for vertex i, exactly, where they lie on a lattice.
struct ExactDefects {
  std::uint64_t intersecting_pairs = 0;  // that have more in common than shared corners and edges
  std::uint64_t degenerate = 0;          // triangles without an area there; in no pair
};
ExactDefects find_exact_defects(std::span<const LatticePoint> positions,
                                std::span<const std::array<std::uint32_t, 3>> triangles);

}  // namespace voxweld::testing
