// Which triangle is nearest to a point, and how far.
#pragma once

#include <cstdint>
#include <vector>

#include "stages/exact/triangle_pair.h"
#include "stages/refine/nearest_kernels.h"
#include "storage/types/lattice_box.h"
#include "storage/types/tile_mesh.h"

namespace voxweld {

double squared_distance(const LatticePoint& point, const LatticeTriangle& triangle);

// A triangle to measure many points from.
class MeasuredTriangle {
 public:
  explicit MeasuredTriangle(const LatticeTriangle& shape);
  double squared_distance(const LatticePoint& point) const;
  const MeasuredShape& shape() const { return shape_; }

 private:
  MeasuredShape shape_;  // its sides are 0
};

// Of few triangles the nearest to each of many points, among those that separate the same. Eight points
// are looked up at once, since one alone costs as much.
class NearestTriangles {
 public:
  void clear() {
    shapes_.clear();
    sides_.clear();
    points_ = 0;
  }
  void add(const LatticeTriangle& shape, const MaterialPair& sides);
  // The next point. Precondition: fewer than eight wait.
  void ask(const LatticePoint& point, const MaterialPair& sides);
  std::size_t waiting() const { return points_; }
  bool is_full() const { return points_ == lanes; }
  // Looks them up; they wait no longer. The results are theirs in the order of asking.
  const NearestLanes& answer();

 private:
  double number_of(const MaterialPair& sides) const;  // of new ones the next

  // The first ones have the alignment of vectors.
  PointLanes asked_{};
  NearestLanes found_{};
  NearestKernel kernel_ = nearest_kernel();
  std::vector<MeasuredShape> shapes_;
  std::vector<MaterialPair> sides_;  // of triangles, each once
  std::size_t points_ = 0;
};

}  // namespace voxweld
