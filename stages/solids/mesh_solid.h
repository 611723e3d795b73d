// A closed triangle mesh as a solid: the sides of lattice points, and the crossings and normals of
// lattice edges, in exact arithmetic.
//
// Based on: Edelsbrunner, Muecke, "Simulation of Simplicity", ACM Trans. Graphics 9(1), 1990, and
// the even-odd rule along rows. Here every lattice point is moved by the same (e, e^2, e^3), e
// smaller than any number: no row then meets an edge or a corner of the mesh and no point lies on a
// triangle, whatever lies on what before. So a point's side is the same along whichever axis it is
// looked for, and an edge's ends are on different sides exactly where an odd number of triangles
// cross it: there is always one to take the crossing and the normal from.
//
// Corners are snapped to 2^-20 of a cell; all that follows is integers of 64 and 128 bits. Neither
// the order of the triangles, nor the way they wind, nor the brick that asks changes a bit of the
// answers.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "stages/solids/block_set.h"
#include "stages/solids/lattice_solid.h"
#include "stages/solids/mesh_row_index.h"
#include "storage/types/triangle_mesh.h"

namespace voxweld {

// Whether the triangle can have a say in the samples of a box and the edges between them: whether
// its own box and its plane meet it, and rows of samples may meet the triangle there. corners: in
// steps of snapped_corner. Precondition: not empty.
bool triangle_reaches(const std::array<Index3, 3>& corners, const Box3& samples);

class MeshSolid final : public LatticeSolid {
 public:
  // Places further than this from sample 0, in cells on any axis, do not fit the arithmetic.
  static constexpr double reach = 1 << 20;

  // mesh: closed (every edge used an even number of times), in the frame spacing * sample index,
  // within reach. source: of what it was made from.
  MeshSolid(const TriangleMesh& mesh, const VolumeFrame& frame, Hash128 source);
  // Of a part of a mesh, asked for no more than these samples: its bounds, crossings and flips are
  // those of the part. corners: snapped, three of each triangle.
  MeshSolid(std::vector<Index3> corners, const Box3& samples, Vec3 spacing, Hash128 source);

  const Bounds& bounds() const override { return bounds_; }
  Hash128 source() const override { return source_; }
  std::uint64_t bytes() const;  // of memory it holds

  void each_flip(const Box3& samples, const std::function<void(const Flip&)>& flip) const override;
  Crossing crossing(int axis, Index3 s, bool low_inside) const override;
  std::optional<bool> side(const Box3& samples) const override;

 private:
  void find_bounds();
  void index_rows(const Box3& samples);
  using Corners = std::array<Index3, 3>;
  Corners corners(std::uint32_t triangle) const {
    const auto& t = triangles_[triangle];
    return {points_[t[0]], points_[t[1]], points_[t[2]]};
  }

  std::vector<Index3> points_;  // in steps of the fixed-point grid
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::array<MeshRowIndex, 3> rows_;  // by the axis the rows are along
  BlockSet blocks_;                   // with triangles
  Vec3 spacing_;
  Bounds bounds_;
  Hash128 source_;
};

}  // namespace voxweld
