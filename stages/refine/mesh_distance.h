// How far two meshes are from each other, at points of their triangles.
#pragma once

#include <vector>

#include "stages/exact/box_tree.h"
#include "storage/types/refine_mesh.h"

namespace voxweld {

// Distances of points from a mesh. The mesh outlives it.
class MeshDistance {
 public:
  explicit MeshDistance(const RefineMesh& mesh);

  // How far the point is from the mesh, or `least` where it is no farther than that: which costs much
  // less to find. Lattice steps. `least` alone where the mesh has no triangle.
  double beyond(const LatticePoint& point, double least) const;
  // The same of squares. They are not rounded on the way: so the largest of many points does not
  // depend on their order. Points that come one near the other are quicker with the same hint.
  struct Hint {
    std::uint32_t place = 0;  // of the group that the point before was near
  };
  double squared_beyond(const LatticePoint& point, double least, Hint& hint) const;
  // Bytes it takes at most.
  static std::uint64_t bytes(std::uint64_t triangles);

 private:
  double nearest_in(std::uint32_t group, const LatticePoint& point, const LatticeBox& box,
                    double enough) const;

  const RefineMesh& mesh_;
  BoxTree groups_;  // of triangles that follow each other
};

// Which triangles' points are measured.
enum class MeasuredPoints : std::uint8_t {
  all,         // corners, the middles of edges and of triangles, and more in large ones
  long_edges,  // the middles of edges twice as long as they are in the mean
};

// The largest distance from `to` of points of `from`, to half a lattice step, or `least` where none is
// farther. It depends on the triangles, and not on their order.
double largest_distance(const RefineMesh& from, MeasuredPoints points, const MeshDistance& to,
                        double least);

}  // namespace voxweld
