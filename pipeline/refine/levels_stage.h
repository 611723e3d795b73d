// Levels: coarser versions of the mesh, node by node of a tree above its tiles (level_tree.h).
#pragma once

#include <memory>
#include <vector>

#include "pipeline/refine/node_reads.h"
#include "pipeline/stage/stage_work.h"
#include "storage/types/tile_mesh.h"

namespace voxweld {

// Units are nodes, children in rounds before their parents. Sources outlive the work.
std::unique_ptr<StageWork> levels_stage(const NodeSources& sources);

// What the stage has left, as encode takes it. Thread-safe.
class LevelMeshes {
 public:
  explicit LevelMeshes(const NodeSources& sources) : sources_(sources) {}

  const LevelTree& tree() const { return sources_.tree; }
  double tolerance(int height) const;  // in lattice steps
  Hash128 content(std::uint64_t node) const;
  PlannedTile size(std::uint64_t node) const;  // with half as many polygons as triangles
  TileMesh read(std::uint64_t node) const;
  RefineCounts counts(std::uint64_t node) const;

 private:
  CubeMeshArtifact open(std::uint64_t node) const;

  const NodeSources sources_;
};

}  // namespace voxweld
