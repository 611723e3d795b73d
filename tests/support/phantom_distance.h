// Distances between a mesh and the true surface of a phantom, both ways.
#pragma once

#include <vector>

#include "pipeline/phantom/fields.h"
#include "tests/support/mesh_distance.h"

namespace voxweld {

// Distances from the mesh to field's surface (a missing piece of mesh goes unseen). Vertices are in
// voxel coordinates: sample (i, j, k) at (i, j, k). The same result whatever the threads.
inline MeshDistances measure_mesh(const AnalyticField& field, std::span<const Vec3> vertices,
                                  std::span<const TriangleCorners> triangles) {
  return measure_mesh([&](Vec3 p) { return field.surface_distance(p); }, vertices, triangles);
}

// About `count` points of field's surface, or one for each lattice cell that it crosses if those are
// fewer. `size`: samples a side. Cells are chosen by a hash, and so is where in its cell each of
// three lines along the axes runs; a point is where one crosses the surface. So points are spread by
// area, but for the angle to the axes: up to 1.7 times as dense where all three are alike. They are
// not those at which methods that go by the samples are at their best.
std::vector<Vec3> surface_points(const AnalyticField& field, std::int64_t size, std::size_t count);

}  // namespace voxweld
