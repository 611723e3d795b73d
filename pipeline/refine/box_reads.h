// What mend reads: the boxes to be repaired, and of each the pieces that reach into it.
#pragma once

#include <map>
#include <mutex>

#include "pipeline/refine/cube_meshes.h"
#include "stages/refine/mend_boxes.h"

namespace voxweld {

// One box of one label, 0 of one surface.
struct MendBox {
  Material label = 0;
  LatticeBox box;
  CubeKey owner;  // of the unit in whose counts it is
};

// All boxes of a mesh, planned once from what its artifacts say intersects. Thread-safe.
class MendPlan {
 public:
  // meshes: sorted by the cubes of the first pass, which `cubes` are too.
  MendPlan(CubeMeshes& meshes, const RefineFrame& frame, const CubeLattice& cubes)
      : meshes_(meshes), frame_(frame), cubes_(cubes) {}

  // Those that reach into cubes from `begin` on and before `end`, ascending.
  std::vector<MendBox> boxes(const CubeKey& begin, const CubeKey& end);

 private:
  void make();

  CubeMeshes& meshes_;
  const RefineFrame& frame_;
  const CubeLattice& cubes_;
  std::once_flag made_;
  std::vector<MendBox> boxes_;
  std::vector<std::pair<CubeKey, std::uint32_t>> reached_;  // ascending: a cube's key and a box
};

// The pieces of one label with triangles that may meet a box.
class BoxReads {
 public:
  BoxReads(CubeMeshes& meshes, const CubeLattice& cubes, const MendBox& box);

  // Looks at full pieces closer, before all() is asked for: what meets the box is as blocks say, by
  // which the artifacts count triangles, as if those were spread evenly in each, and a quarter more.
  // There few triangles are longer than some cells.
  void limit(const CubeLattice& blocks);

  const MendBox& box() const { return box_; }
  // What meets the box, at most.
  const PartCounts& all() const { return all_; }
  std::uint64_t largest_part_bytes() const { return largest_part_; }
  void add_hashes(KeyHasher& key) const;
  // The triangles that meet the box.
  RefineMesh read(const std::function<void()>& between) const;

 private:
  struct Read {
    std::size_t artifact = 0, piece = 0;
    CubePart part = CubePart::inside;
  };

  double triangles_near(const CubeLattice& blocks) const;

  CubeMeshes& meshes_;
  MendBox box_;
  std::vector<Read> parts_;
  PartCounts all_;
  std::uint64_t largest_part_ = 0;
};

}  // namespace voxweld
