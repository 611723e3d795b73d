#include "pipeline/stage/level_meshes.h"

#include <algorithm>

#include "stages/refine/coarsen.h"
#include "stages/refine/mesh_part.h"
#include "stages/refine/retile.h"

namespace voxweld {

double LevelMeshes::tolerance(int height) const {
  return level_tolerance(job_.parameters.tolerance, height);
}

CubeMeshArtifact LevelMeshes::open(std::uint64_t node) const {
  return CubeMeshArtifact(level_artifact_path(job_.folder, tree().nodes()[node]));
}

Hash128 LevelMeshes::content(std::uint64_t node) const {
  return open(node).content_hash();
}

PlannedTile LevelMeshes::size(std::uint64_t node) const {
  const PartCounts all = open(node).summary().all;
  const CellKey cell = tree().nodes()[node].cell;
  return {cell.code(), static_cast<std::uint32_t>(cell.level), 0, all.vertices,
          (all.triangles + 1) / 2};
}

TileMesh LevelMeshes::read(std::uint64_t node) const {
  const CubeMeshArtifact artifact = open(node);
  MeshGather mesh;
  const PartFields wanted{.normals = job_.normals, .aims = false, .samples = false};
  for (std::size_t p = 0; p < artifact.pieces().size(); ++p) {
    mesh.add(artifact.read(p, CubePart::inside, wanted));
    mesh.add(artifact.read(p, CubePart::leaving, wanted));
  }
  return to_tile_mesh(mesh.mesh(), tree().nodes()[node].cell, job_.lattice,
                      tile_blocks(job_.frame));
}

RefineCounts LevelMeshes::counts(std::uint64_t node) const {
  return open(node).counted<RefineCounts>();
}

std::vector<LevelError> LevelMeshes::errors() const {
  std::vector<LevelError> errors;
  for (std::uint64_t n = 0; n < tree().nodes().size(); ++n) {
    LevelError error;
    for (const std::uint64_t child : tree().nodes()[n].nodes) {
      error.worst = std::max(error.worst, errors[child].worst);
      error.p99 = std::max(error.p99, errors[child].p99);
    }
    const RefineCounts own = counts(n);
    error.worst += own.worst;
    error.p99 += own.quantile(0.99);
    errors.push_back(error);
  }
  return errors;
}

}  // namespace voxweld
