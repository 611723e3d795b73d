// What mend reads: of each box the pieces that reach into it.
#pragma once

#include <map>

#include "pipeline/refine/cube_meshes.h"
#include "pipeline/refine/mend_plan.h"
#include "stages/exact/box_tree.h"

namespace voxweld {

// Of a part of a piece the triangles that meet one of some boxes.
class HeldPart {
 public:
  HeldPart(RefineMesh part, const BoxTree& boxes);

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

struct PartOfPiece {
  std::size_t artifact = 0, piece = 0;
  CubePart part = CubePart::inside;
  auto operator<=>(const PartOfPiece&) const = default;
};

// What some boxes read. Parts that are kept are read once; of others the last few are held.
class HeldParts {
 public:
  static constexpr std::uint64_t most_others_bytes = 4 << 20;

  HeldParts(CubeMeshes& meshes, const std::vector<LatticeBox>& boxes)
      : meshes_(meshes), boxes_(boxes) {}

  // Bytes of a held part, at most.
  static std::uint64_t bytes_of(const PartCounts& counts) {
    return part_bytes(counts) / 2 + HeldPart::bytes(counts.triangles);
  }
  void keep(const PartOfPiece& part) { parts_.emplace(part, read(part)); }
  // Valid until it is called again.
  const HeldPart& get(const PartOfPiece& part);

 private:
  HeldPart read(const PartOfPiece& part) {
    return {meshes_.read(part.artifact, part.piece, part.part), boxes_};
  }

  CubeMeshes& meshes_;
  BoxTree boxes_;
  std::map<PartOfPiece, HeldPart> parts_, others_;
  std::uint64_t others_bytes_ = 0;
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
  const std::vector<PartOfPiece>& parts() const { return parts_; }
  // What meets the box, at most; after limit() about that much.
  const PartCounts& all() const { return all_; }
  std::uint64_t largest_part_bytes() const { return largest_part_; }
  void add_hashes(KeyHasher& key) const;
  // The triangles that meet the box, which is one of those of `held`.
  RefineMesh read(HeldParts& held, const std::function<void()>& between) const;

 private:
  double triangles_near(const CubeLattice& blocks) const;

  CubeMeshes& meshes_;
  MendBox box_;
  std::vector<PartOfPiece> parts_;
  std::vector<std::size_t> counted_;  // artifacts that count triangles near the box
  PartCounts all_;
  std::uint64_t largest_part_ = 0;
};

}  // namespace voxweld
