// The plan of tiles of a refined mesh, as retile leaves it. Kind "tpln", a container with these
// sections:
//   1  PlannedTile, in Morton order
//   2  PlanSource of each artifact it was made of (cube_mesh_artifact.h), in their order
#pragma once

#include "storage/artifact/container.h"
#include "storage/types/top_tree.h"

namespace voxweld {

inline constexpr std::array<char, 4> tile_plan_kind = {'t', 'p', 'l', 'n'};
inline constexpr std::uint32_t tile_plan_version = 1;

// Where the pieces of one artifact lie.
struct PlanSource {
  Hash128 content;
  std::uint64_t pieces = 0;
  std::uint64_t lowest_code = 0, highest_code = 0;  // where there are pieces
  friend bool operator==(const PlanSource&, const PlanSource&) = default;
};

struct TilePlanParts {
  std::vector<PlannedTile> tiles;
  std::vector<PlanSource> sources;
};

void write_tile_plan(const std::filesystem::path& path, Hash128 key, const TilePlanParts& parts);

class TilePlanArtifact : public OpenArtifact {
 public:
  explicit TilePlanArtifact(const std::filesystem::path& path)
      : OpenArtifact(path, tile_plan_kind, tile_plan_version) {}
  TilePlanParts read() const;
};

}  // namespace voxweld
