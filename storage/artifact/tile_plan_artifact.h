// The plan of tiles of a refined mesh, as retile leaves it. Kind "tpln", a container with these
// sections:
//   2            PlanSource of each artifact it was made of (cube_mesh_artifact.h), in their order
//   7 << 56 | i  page i of the middles: of each material's mesh, as Morton code of a finest cell
// and the tables of material_top.h, without nodes and leaves: of each material the tiles.
#pragma once

#include "storage/artifact/cube_mesh_artifact.h"
#include "storage/artifact/material_top.h"
#include "storage/types/top_tree.h"

namespace voxweld {

inline constexpr std::array<char, 4> tile_plan_kind = {'t', 'p', 'l', 'n'};
inline constexpr std::uint32_t tile_plan_version = 5;

// Where the pieces of one artifact lie.
struct PlanSource {
  Hash128 content;
  std::uint64_t pieces = 0;
  CubeKey lowest, highest;  // where there are pieces
  friend bool operator==(const PlanSource&, const PlanSource&) = default;
};

class TilePlanWriter : public MaterialTablesWriter {
 public:
  TilePlanWriter(const std::filesystem::path& path, Hash128 key);
  // Where about the mesh of the material lies that is ended next.
  void middle(std::uint64_t code) { middles_.push(code); }
  Hash128 finish(std::span<const PlanSource> sources);

 private:
  PagedTableWriter<std::uint64_t> middles_;
};

class TilePlanArtifact : public OpenArtifact {
 public:
  explicit TilePlanArtifact(const std::filesystem::path& path);
  std::vector<PlanSource> sources() const;
  // Of the surfaces with these numbers.
  std::vector<std::uint64_t> middles(std::uint64_t first, std::uint64_t count) const;
  const ArtifactReader& file() const { return file_; }
};

}  // namespace voxweld
