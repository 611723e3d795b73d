// The plan of tiles of a refined mesh, as retile leaves it. Kind "tpln", a container with these
// sections:
//   2  PlanSource of each artifact it was made of (cube_mesh_artifact.h), in their order
// and the tables of material_top.h, without nodes and leaves: of each material the tiles.
#pragma once

#include "storage/artifact/cube_mesh_artifact.h"
#include "storage/artifact/material_top.h"
#include "storage/types/top_tree.h"

namespace voxweld {

inline constexpr std::array<char, 4> tile_plan_kind = {'t', 'p', 'l', 'n'};
inline constexpr std::uint32_t tile_plan_version = 4;

// Where the pieces of one artifact lie.
struct PlanSource {
  Hash128 content;
  std::uint64_t pieces = 0;
  CubeKey lowest, highest;  // where there are pieces
  friend bool operator==(const PlanSource&, const PlanSource&) = default;
};

class TilePlanWriter : public MaterialTablesWriter {
 public:
  TilePlanWriter(const std::filesystem::path& path, Hash128 key)
      : MaterialTablesWriter(path, {tile_plan_kind, tile_plan_version, key}) {}
  Hash128 finish(std::span<const PlanSource> sources);
};

class TilePlanArtifact : public OpenArtifact {
 public:
  explicit TilePlanArtifact(const std::filesystem::path& path);
  std::vector<PlanSource> sources() const;
  const ArtifactReader& file() const { return file_; }
};

}  // namespace voxweld
