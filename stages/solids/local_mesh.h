// A mesh as one box of samples sees it: the triangles that reach the box, and for each row along x
// the side it enters on, which is what all the others come to. It answers as MeshSolid does of the
// whole mesh, bit for bit.
#pragma once

#include "stages/solids/mesh_solid.h"
#include "storage/types/mesh_bin.h"

namespace voxweld {

struct LocalMeshFrame {
  Box3 samples;
  Vec3 spacing;
  Bounds bounds;   // of the whole mesh
  Hash128 source;  // of it
};

class LocalMesh final : public LatticeSolid {
 public:
  // bin: of frame.samples, with every triangle that triangle_reaches says reaches them.
  LocalMesh(MeshBin&& bin, const LocalMeshFrame& frame);

  // At most, of one with so many triangles, while it is made and after.
  static std::uint64_t memory_bytes(std::uint64_t triangles, const Box3& samples);

  const Bounds& bounds() const override { return frame_.bounds; }
  Hash128 source() const override { return frame_.source; }
  // samples: within those of the frame.
  void each_flip(const Box3& samples, const std::function<void(const Flip&)>& flip) const override;
  Crossing crossing(int axis, Index3 s, bool low_inside) const override {
    return mesh_.crossing(axis, s, low_inside);
  }

  // The sides that rows of the same y and z have at a higher x, one of the frame's: as
  // MeshBin::first of a box that begins there.
  std::vector<std::uint64_t> sides_at(std::int64_t x) const;

 private:
  LocalMeshFrame frame_;
  std::vector<std::uint64_t> first_;
  MeshSolid mesh_;
};

}  // namespace voxweld
