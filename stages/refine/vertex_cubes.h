// In which cubes of a lattice a mesh lies.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "stages/refine/cube_lattice.h"
#include "storage/types/box.h"
#include "storage/types/refine_mesh.h"

namespace voxweld {

// Finds each vertex' cube once. The mesh outlives it and stays as it is.
class VertexCubes {
 public:
  static constexpr std::uint64_t bytes = 6;  // for each vertex

  VertexCubes(const RefineMesh& mesh, const CubeLattice& cubes) : mesh_(mesh) {
    cubes_.reserve(mesh.positions.size());
    NearbyCubes nearby(cubes);
    for (const LatticePoint& p : mesh.positions) {
      nearby.moves_to(p);
      const Index3 cube = nearby.cube();
      cubes_.push_back({static_cast<std::uint16_t>(cube.x), static_cast<std::uint16_t>(cube.y),
                        static_cast<std::uint16_t>(cube.z)});
    }
  }

  // The cube a triangle is at home in.
  Index3 home(std::size_t triangle) const { return cube(mesh_.triangles[triangle][0]); }
  // All corners lie in one cube.
  bool is_inside(std::size_t triangle) const {
    const auto& c = mesh_.triangles[triangle];
    return cubes_[c[0]] == cubes_[c[1]] && cubes_[c[0]] == cubes_[c[2]];
  }
  // The cubes that its box meets.
  Box3 around(std::size_t triangle) const {
    const auto& c = mesh_.triangles[triangle];
    Box3 box{cube(c[0]), cube(c[0])};
    for (std::size_t k = 1; k < 3; ++k) {
      const Index3 at = cube(c[k]);
      for (int a = 0; a < 3; ++a) {
        box.lo[a] = std::min(box.lo[a], at[a]);
        box.hi[a] = std::max(box.hi[a], at[a]);
      }
    }
    box.hi = box.hi + splat(1);
    return box;
  }

 private:
  struct Cube {  // a volume has 2^15 a side at most
    std::uint16_t x, y, z;
    bool operator==(const Cube&) const = default;
  };
  Index3 cube(std::uint32_t vertex) const {
    const Cube& c = cubes_[vertex];
    return {c.x, c.y, c.z};
  }

  const RefineMesh& mesh_;
  std::vector<Cube> cubes_;
};

}  // namespace voxweld
