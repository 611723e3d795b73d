// How far a mesh lies from the surface it stands for.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "pipeline/phantom/fields.h"
#include "storage/types/box.h"

namespace voxweld {

// Of distances to the surface, in voxels; all zero when count is.
struct DistanceStatistics {
  double max = 0;
  double mean = 0;
  double p99 = 0;  // 99 of 100 distances are at most this; rounded up by at most 1 part in 1024
  std::uint64_t count = 0;
};

struct MeshDistance {
  DistanceStatistics vertices;
  // Ten points a triangle, evenly spread inside it (barycentric (i + 1/3, j + 1/3, k + 1/3) / 4
  // with i + j + k = 3), every triangle counting the same.
  DistanceStatistics triangles;
};

using TriangleCorners = std::array<std::uint32_t, 3>;

// Distances from the mesh to field's surface (mesh to surface only: a missing piece of mesh goes
// unseen). Vertices are in voxel coordinates: sample (i, j, k) at (i, j, k). Precondition:
// triangles index vertices. Runs on the current TBB arena; the same result whatever the threads.
MeshDistance measure_mesh(const AnalyticField& field, std::span<const Vec3> vertices,
                          std::span<const TriangleCorners> triangles);
MeshDistance measure_mesh(const AnalyticField& field,
                          std::span<const std::array<float, 3>> vertices,
                          std::span<const TriangleCorners> triangles);

}  // namespace voxweld
