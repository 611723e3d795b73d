// The tiles of coarser levels as the stage levels leaves them and encode takes them.
#pragma once

#include "pipeline/stage/level_tree.h"
#include "pipeline/stage/stage_jobs.h"
#include "stages/refine/refine_range.h"
#include "storage/artifact/cube_mesh_artifact.h"
#include "storage/types/tile_mesh.h"

namespace voxweld {

// Thread-safe.
class LevelMeshes {
 public:
  // Both outlive it.
  LevelMeshes(const LevelsJob& job, const LevelTree& tree) : job_(job), tree_(tree) {}

  const LevelTree& tree() const { return tree_; }
  double tolerance(int height) const;  // in lattice steps
  Hash128 content(std::uint64_t node) const;
  PlannedTile size(std::uint64_t node) const;  // with half as many polygons as triangles
  TileMesh read(std::uint64_t node) const;
  RefineCounts counts(std::uint64_t node) const;
  // Of each node, in lattice steps: how far it may be from the mesh that it stands for, or that from it.
  // How far it is from its children was measured, and they have errors of their own.
  std::vector<double> errors() const;

 private:
  CubeMeshArtifact open(std::uint64_t node) const;

  const LevelsJob& job_;
  const LevelTree& tree_;
};

}  // namespace voxweld
