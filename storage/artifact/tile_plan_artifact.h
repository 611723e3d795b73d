// The plan of tiles of a refined mesh, as retile leaves it. Kind "tpln", a container with these
// sections:
//   1  PlannedTile, in Morton order
//   2  PlanSource of each artifact it was made of (cube_mesh_artifact.h), in their order
// With labels.mode = "each" there is a plan for each label: section 2 is the same, and in place of
// section 1 are the tables of material_top.h, sections 5 on, without nodes and leaves.
#pragma once

#include "storage/artifact/cube_mesh_artifact.h"
#include "storage/artifact/material_top.h"
#include "storage/types/top_tree.h"

namespace voxweld {

inline constexpr std::array<char, 4> tile_plan_kind = {'t', 'p', 'l', 'n'};
inline constexpr std::uint32_t tile_plan_version = 2;

// Where the pieces of one artifact lie.
struct PlanSource {
  Hash128 content;
  std::uint64_t pieces = 0;
  CubeKey lowest, highest;  // where there are pieces
  friend bool operator==(const PlanSource&, const PlanSource&) = default;
};

struct TilePlanParts {
  std::vector<PlannedTile> tiles;
  std::vector<PlanSource> sources;
};

void write_tile_plan(const std::filesystem::path& path, Hash128 key, const TilePlanParts& parts);

class LabelTilePlanWriter : public MaterialTablesWriter {
 public:
  LabelTilePlanWriter(const std::filesystem::path& path, Hash128 key)
      : MaterialTablesWriter(path, {tile_plan_kind, tile_plan_version, key}) {}
  Hash128 finish(std::span<const PlanSource> sources);
};

class TilePlanArtifact : public OpenArtifact {
 public:
  explicit TilePlanArtifact(const std::filesystem::path& path);
  bool of_labels() const;
  std::vector<PlannedTile> tiles() const;  // of one surface
  std::vector<PlanSource> sources() const;
  const ArtifactReader& file() const { return file_; }
};

}  // namespace voxweld
