#include "pipeline/stage/level_meshes.h"

#include <algorithm>

#include "stages/refine/coarsen.h"
#include "stages/refine/mesh_part.h"
#include "stages/refine/retile.h"

namespace voxweld {
namespace {

// f(first piece, behind the last) of each label.
template <class F>
void each_label(const CubeMeshArtifact& artifact, F&& f) {
  const auto pieces = artifact.pieces();
  for (std::size_t begin = 0, end = 0; begin < pieces.size(); begin = end) {
    while (end < pieces.size() && pieces[end].label == pieces[begin].label) ++end;
    f(begin, end);
  }
}

void append(TileMesh& all, const TileMesh& mesh, Material label) {
  const auto add = [](auto& to, const auto& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  const auto first = static_cast<std::uint32_t>(all.positions.size());
  const auto pair = static_cast<std::uint32_t>(all.pairs.size());
  all.pairs.push_back({label, exterior});
  all.triangle_pairs.insert(all.triangle_pairs.end(), mesh.triangles.size(), pair);
  for (const auto& t : mesh.triangles)
    all.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  add(all.positions, mesh.positions);
  add(all.ids, mesh.ids);
  add(all.normals, mesh.normals);
  add(all.corner_normals, mesh.corner_normals);
  all.quads += mesh.quads;
  all.polygon_triangles += mesh.polygon_triangles;
  all.collinear += mesh.collinear;
}

}  // namespace

double LevelMeshes::tolerance(std::uint64_t node) const {
  return level_tolerance(job_.parameters.tolerance, tree().nodes()[node].doublings);
}

double LevelMeshes::largest_tolerance() const {
  double largest = job_.parameters.tolerance;
  for (std::uint64_t n = 0; n < tree().nodes().size(); ++n)
    largest = std::max(largest, tolerance(n));
  return largest;
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

std::uint64_t LevelMeshes::labels(std::uint64_t node) const {
  if (!tree().of_labels()) return 0;
  std::uint64_t labels = 0;
  const CubeMeshArtifact artifact = open(node);
  each_label(artifact, [&](std::size_t, std::size_t) { ++labels; });
  return labels;
}

TileMesh LevelMeshes::read(std::uint64_t node) const {
  const CubeMeshArtifact artifact = open(node);
  const PartFields wanted{.normals = job_.normals, .aims = false, .samples = false};
  const auto surface = [&](std::size_t begin, std::size_t end) {
    MeshGather mesh;
    for (std::size_t p = begin; p < end; ++p) {
      mesh.add(artifact.read(p, CubePart::inside, wanted));
      mesh.add(artifact.read(p, CubePart::leaving, wanted));
    }
    return to_tile_mesh(mesh.mesh(), tree().nodes()[node].cell, job_.lattice,
                        tile_blocks(job_.frame));
  };
  if (!tree().of_labels()) return surface(0, artifact.pieces().size());
  TileMesh all;
  all.tile = tree().nodes()[node].cell;
  all.lattice = job_.lattice;
  each_label(artifact, [&](std::size_t begin, std::size_t end) {
    append(all, surface(begin, end), artifact.pieces()[begin].label);
  });
  return all;
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
