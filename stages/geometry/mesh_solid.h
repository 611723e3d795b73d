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
// Corners are snapped to 2^-20 of a cell on each axis, so they move by at most 2^-21 cells an axis
// (under a float's own resolution for meshes of more than 16 cells); all that follows is integers
// of 64 and 128 bits. Neither the order of the triangles, nor the way they wind, nor the brick that
// asks changes a bit of the answers.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "stages/geometry/mesh_row_index.h"
#include "stages/geometry/solid.h"
#include "stages/geometry/volume_frame.h"
#include "storage/support/hash.h"
#include "storage/types/triangle_mesh.h"

namespace voxweld {

class MeshSolid {
 public:
  // Places further than this from sample 0, in cells on any axis, do not fit the arithmetic.
  static constexpr double reach = 1 << 20;

  // mesh: closed (every edge used an even number of times), in output coordinates, within reach.
  // source: of what it was made from, for the keys of artifacts.
  MeshSolid(const TriangleMesh& mesh, const VolumeFrame& frame, Hash128 source);

  const Bounds& bounds() const { return bounds_; }
  Hash128 source() const { return source_; }
  std::uint64_t bytes() const;  // of memory it holds

  // One side change of a row of samples along x: of (x, y, z) and all after it in the row.
  struct Flip {
    std::int64_t x, y, z;
  };
  // Tells the flips of the rows through `samples` that come before its end, those before its first
  // sample at that, in any order. Without flips all of a row is outside.
  void each_flip(const Box3& samples, const std::function<void(const Flip&)>& flip) const;

  struct Crossing {
    double t = 0.5;  // 0 at the edge's low end
    Vec3 normal;     // unit, outward
  };
  // Of the edge along `axis` from sample s to the next. Where it is crossed several times it is the
  // crossing nearest the outside end, as an `add` takes the outer of two surfaces: all of the solid
  // that lies on the edge stays in it, and the normal there leads out.
  // Precondition: the ends are on different sides; both are samples of the frame.
  Crossing crossing(int axis, Index3 s, bool low_inside) const;

 private:
  using Corners = std::array<Index3, 3>;
  Corners corners(std::uint32_t triangle) const {
    const auto& t = triangles_[triangle];
    return {points_[t[0]], points_[t[1]], points_[t[2]]};
  }

  std::vector<Index3> points_;  // in steps of the fixed-point grid
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::array<MeshRowIndex, 3> rows_;  // by the axis the rows are along
  Vec3 spacing_;
  Bounds bounds_;
  Hash128 source_;
};

}  // namespace voxweld
