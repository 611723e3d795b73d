// Straight prisms over plane outlines, as closed triangle meshes.
#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "storage/types/triangle_mesh.h"

namespace voxweld::paper {

using Point2 = std::array<double, 2>;
using Contour = std::vector<Point2>;  // closed; the last point is joined to the first
// Inside is what an odd number of contours go around: holes are contours too, whichever way they
// wind.
using Outline = std::vector<Contour>;

bool holds(const Outline& outline, Point2 p);

// Regular, its first corner on the first axis.
Contour regular_polygon(int sides, double radius);

// Where the outline's two axes and the prism's own (its third) point, and where its origin lies.
// Orthonormal; the third is the cross product of the others.
struct Frame3 {
  Vec3 origin;
  std::array<Vec3, 3> axes = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  Vec3 place(Vec3 q) const { return origin + axes[0] * q.x + axes[1] * q.y + axes[2] * q.z; }
};

// What lies over the outline between `low` and `high` on the third axis. A lid is a fan from each
// contour's first corner: where its triangles overlap an even number of times there is none, so
// concave contours and holes need no triangulation, as long as inside is told by the even-odd rule
// (stages/solids/mesh_solid.h). Every edge is used an even number of times.
TriangleMesh extrude(const Outline& outline, double low, double high, const Frame3& frame);

// As .off, every digit that it takes. StorageError where it cannot be written.
void write_off(const std::filesystem::path& path, const TriangleMesh& mesh);

}  // namespace voxweld::paper
