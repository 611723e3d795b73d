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
  // places: artifacts that say what intersects. cubes: of the first pass.
  MendPlan(CubeMeshes& places, const RefineFrame& frame, const MendRoom& room,
           const CubeLattice& cubes)
      : places_(places), frame_(frame), room_(room), cubes_(cubes) {}

  // Of the places that one artifact lists the boxes that end where their cubes do: so no unit has to know
  // the places of others.
  std::vector<MendBox> boxes_within(std::size_t artifact) const;

  // Whether there are so few places that all may be in memory at once. It depends on the mesh alone.
  bool holds_all();
  // What it takes then.
  std::uint64_t bytes() { return holds_all() ? places_count_ * bytes_of_place : 0; }

  // Those that reach into cubes from `begin` on and before `end`, ascending.
  std::vector<MendBox> boxes(const CubeKey& begin, const CubeKey& end);

 private:
  static constexpr std::uint64_t bytes_of_place = 200;

  void make();

  CubeMeshes& places_;
  const RefineFrame& frame_;
  const MendRoom& room_;
  const CubeLattice& cubes_;
  std::once_flag counted_, made_;
  std::uint64_t places_count_ = 0;
  std::vector<MendBox> boxes_;
  std::vector<std::pair<CubeKey, std::uint32_t>> reached_;  // ascending: a cube's key and a box
};

// A part of a piece, read once for several boxes.
struct HeldPart {
  explicit HeldPart(RefineMesh part);

  RefineMesh mesh;
  std::vector<LatticeBox> boxes;  // around its triangles
};

// The pieces of one label with triangles that may meet a box.
class BoxReads {
 public:
  struct Read {
    std::size_t artifact = 0, piece = 0;
    CubePart part = CubePart::inside;
    auto operator<=>(const Read&) const = default;
  };
  using Held = std::map<Read, HeldPart>;

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
  // The triangles that meet the box. held: parts that need not be read.
  RefineMesh read(const Held& held, const std::function<void()>& between) const;

 private:
  double triangles_near(const CubeLattice& blocks) const;

  CubeMeshes& meshes_;
  MendBox box_;
  std::vector<Read> parts_;
  std::vector<std::size_t> counted_;  // artifacts that count triangles near the box
  PartCounts all_;
  std::uint64_t largest_part_ = 0;
};

}  // namespace voxweld
