// What mend reads: of each box the pieces that reach into it.
#pragma once

#include <map>

#include "pipeline/refine/cube_meshes.h"
#include "pipeline/refine/mend_plan.h"

namespace voxweld {

// A part of a piece, read once for several boxes.
class HeldPart {
 public:
  explicit HeldPart(RefineMesh part);

  const RefineMesh& mesh() const { return mesh_; }
  // The triangles that meet the box, ascending.
  std::vector<std::uint32_t> meeting(const LatticeBox& box) const;
  // Bytes beside the mesh.
  static std::uint64_t bytes(std::uint64_t triangles) {
    return triangles * sizeof(LatticeBox) / run + sizeof(LatticeBox);
  }

 private:
  static constexpr std::size_t run = 16;

  RefineMesh mesh_;
  std::vector<LatticeBox>
      around_;  // so many triangles that follow each other, which mostly lie close
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
  // What meets the box, at most; after limit() about that much.
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
