// Which triangle is nearest to a point, and how far.
#pragma once

#include <cstdint>
#include <vector>

#include "stages/exact/triangle_pair.h"
#include "storage/types/lattice_box.h"
#include "storage/types/tile_mesh.h"

namespace voxweld {

double squared_distance(const LatticePoint& point, const LatticeTriangle& triangle);

// squared: infinite where there is none. triangle: which; of equal ones the first.
struct Nearest {
  double squared = 0;
  std::size_t triangle = 0;
};

// A triangle to measure many points from. What does not depend on the point is computed once: the ways
// from the first corner to the others, their products and the normal. All but the normal's square are
// integers of less than 53 bits as long as sides have 25, so nothing is lost.
class MeasuredTriangle {
 public:
  explicit MeasuredTriangle(const LatticeTriangle& shape);
  double squared_distance(const LatticePoint& point) const;

 private:
  LatticePoint first_;
  Vec3 ab_, ac_, normal_;
  double abab_, abac_, acac_, nn_;
};

// Of few triangles the nearest to each of many points, among those that separate the same.
class NearestTriangles {
 public:
  void clear() {
    triangles_.clear();
    measured_.clear();
  }
  void add(const LatticeTriangle& shape, const MaterialPair& sides);
  // guess: of the triangle that may well be it; any number will do. enough: the square of a distance
  // at which any triangle will do. To the bit what a look at all of them says, or where it says no more
  // than enough, something else that is no more: a triangle is passed over only where its box is
  // further than another triangle.
  Nearest to(const LatticePoint& point, const MaterialPair& sides, std::size_t guess,
             double enough = -1);

 private:
  static constexpr std::size_t lanes = 4;
  using Ints = std::int32_t __attribute__((vector_size(16)));
  using Floats = float __attribute__((vector_size(16)));
  struct Triangle {
    LatticeTriangle shape;
    MaterialPair sides;
    std::uint32_t measured;  // its number in measured_, from 1 on; 0 where nobody has asked for it
  };
  double squared_distance(std::size_t triangle, const LatticePoint& point);
  // Boxes of four triangles, to which distances are computed at once.
  struct Boxes {
    Ints lo[3], hi[3];
    Floats squared_distances(const LatticePoint& point) const;
  };
  std::vector<Triangle> triangles_;
  std::vector<MeasuredTriangle> measured_;  // those that were near enough to be looked at
  std::vector<Boxes>
      boxes_;  // of a group of triangles; those beyond the last triangle are not looked at
};

}  // namespace voxweld
