// A triangle mesh with holes, or one that overlaps itself, as a solid: inside is where its winding
// number (stages/solids/winding_number.h) is at least 1/2.
//
// All points are moved by the same few millionths of a cell, so that none lies on a triangle whose
// plane runs through lattice points; the brick that asks changes nothing. An edge that a triangle
// crosses where the side changes takes crossing and normal from it; in a hole the crossing is where
// the number is 1/2 and the normal its gradient. Outside of the mesh's bounding box all is outside.
#pragma once

#include <vector>

#include "stages/solids/lattice_solid.h"
#include "stages/solids/winding_number.h"
#include "storage/types/triangle_mesh.h"

namespace voxweld {

class WoundMesh final : public LatticeSolid {
 public:
  // mesh: in the frame spacing * sample index, outward on the whole (else it is turned around),
  // within MeshSolid::reach. source: of its file.
  WoundMesh(const TriangleMesh& mesh, const VolumeFrame& frame, Hash128 source);

  const Bounds& bounds() const override { return bounds_; }
  Hash128 source() const override { return source_; }
  void each_flip(const Box3& samples, const std::function<void(const Flip&)>& flip) const override;
  Crossing crossing(int axis, Index3 s, bool low_inside) const override;

  std::size_t open_edges() const { return winding_.open_edges(); }

 private:
  // An edge from its outside end to its inside end.
  struct Edge;
  Vec3 place(Vec3 index) const;
  bool holds(Vec3 index) const;
  Relation side_of(const Box3& samples) const;
  void fill(const Box3& samples, std::int64_t end,
            const std::function<void(const Flip&)>& flip) const;
  std::optional<Crossing> at_triangle(const Edge& edge) const;
  Crossing in_hole(const Edge& edge) const;

  Vec3 spacing_, scale_;  // scale: of each axis, in the smallest spacing
  Vec3 lo_, hi_;          // of the corners, in cells
  Bounds bounds_;
  Hash128 source_;
  WindingNumber winding_;  // of places: cells times scale
};

}  // namespace voxweld
