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

// Of few triangles the nearest to each of many points, among those that separate the same.
class NearestTriangles {
 public:
  void clear() { triangles_.clear(); }
  void add(const LatticeTriangle& shape, const MaterialPair& sides) {
    triangles_.push_back({shape, LatticeBox::around(shape), sides});
  }
  // guess: of the triangle that may well be it; any number will do. To the bit what a look at all of
  // them says, since a triangle is passed over only where its box is further than another triangle.
  Nearest to(const LatticePoint& point, const MaterialPair& sides, std::size_t guess) const;

 private:
  struct Triangle {
    LatticeTriangle shape;
    LatticeBox box;
    MaterialPair sides;
  };
  std::vector<Triangle> triangles_;
};

}  // namespace voxweld
