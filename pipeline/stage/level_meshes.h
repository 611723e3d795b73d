// The tiles of coarser levels as the stage levels leaves them and encode takes them.
#pragma once

#include "pipeline/stage/level_tree.h"
#include "pipeline/stage/stage_jobs.h"
#include "stages/refine/refine_range.h"
#include "storage/artifact/cube_mesh_artifact.h"
#include "storage/types/tile_mesh.h"

namespace voxweld {

// How far a coarser tile may be from the mesh that it stands for, lattice steps.
struct LevelError {
  double worst = 0;  // at any point that was measured, either way
  double p99 = 0;    // of the mesh' points 99 % are no farther
};

// Thread-safe.
class LevelMeshes {
 public:
  // Both outlive it.
  LevelMeshes(const LevelsJob& job, const LevelTree& tree) : job_(job), tree_(tree) {}

  const LevelTree& tree() const { return tree_; }
  double tolerance(std::uint64_t node) const;  // in lattice steps
  double largest_tolerance() const;            // of nodes; where there is none, that of the mesh
  Hash128 content(std::uint64_t node) const;
  PlannedTile size(std::uint64_t node) const;  // with half as many polygons as triangles
  // How many labels it has a part of; 0 where there is one surface.
  std::uint64_t labels(std::uint64_t node) const;
  // Of labels all meshes as one, which have no vertex in common: triangles bound a label to the exterior.
  TileMesh read(std::uint64_t node) const;
  RefineCounts counts(std::uint64_t node) const;
  // Of each node: its own distances, as measured, and those of its children.
  std::vector<LevelError> errors() const;

 private:
  CubeMeshArtifact open(std::uint64_t node) const;

  const LevelsJob& job_;
  const LevelTree& tree_;
};

}  // namespace voxweld
