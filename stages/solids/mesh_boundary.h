// Where a triangle mesh is not closed, and how large it is.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "stages/solids/solid.h"
#include "storage/types/triangle_mesh.h"

namespace voxweld {

struct MeshHole {
  std::uint64_t edges = 0;
  Vec3 center;      // of its box
  double size = 0;  // from corner to corner of its box
};

struct MeshBoundary {
  std::uint64_t edges = 0;      // used by an odd number of triangles
  std::vector<MeshHole> holes;  // what hangs together of them, the largest first
  bool closed() const { return edges == 0; }
};

// Edges of more than two triangles are no boundary as long as their number is even: rows still
// cross such a mesh an even number of times. Which way triangles wind is not asked.
MeshBoundary boundary_of(const TriangleMesh& mesh);

// The same of edges that are used by an odd number of triangles, each by the numbers of two places,
// the lower first; places in ascending order.
MeshBoundary boundary_of(std::span<const std::pair<std::uint32_t, std::uint32_t>> odd_edges,
                         std::span<const Vec3> places);

// Of its triangles. Precondition: there are any.
Bounds bounds_of(const TriangleMesh& mesh);

// Of what it encloses; negative where the triangles wind inward.
double signed_volume(const TriangleMesh& mesh);

}  // namespace voxweld
