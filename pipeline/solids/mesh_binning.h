// A mesh cut up by the bricks of a volume: for each brick the triangles that reach it, on disk.
//
// Triangles are sorted by shard and brick. Then one pass over the bricks that any reach, along x
// within each row of shards, finds for each row of samples the side it enters a brick on, by what
// the brick before it makes of it (LocalMesh): the very side that all triangles of the mesh give
// it. Bricks and shards that none reaches keep one side.
#pragma once

#include <filesystem>

#include "pipeline/solids/spooled_mesh.h"
#include "stages/contouring/brick_grid.h"
#include "storage/artifact/mesh_bin_artifact.h"
#include "storage/types/volume.h"

namespace voxweld {

// Where the bins of a mesh are, and what decides what is in them.
struct MeshBinning {
  BrickGrid grid;
  VolumeGeometry geometry;
  std::filesystem::path folder;
  Hash128 key;     // of all that
  Hash128 source;  // of the mesh

  std::filesystem::path table_path() const { return folder / "table"; }
  std::filesystem::path bins_path(Index3 shard) const;
  // The samples whose sides a brick looks at.
  Box3 samples_of(Index3 brick) const;
  std::uint64_t shard_number(Index3 shard) const;
  // Within its shard.
  std::uint64_t brick_number(Index3 brick) const;
};

struct BinLimits {
  std::uint64_t budget = 0;          // run.memory
  std::uint64_t while_binning = 0;   // bytes one bin may take here
  std::uint64_t while_building = 0;  // and in build
};

// Writes what is missing of the bins, and the table last. Corners go from the mesh's coordinates to
// those of sample 0 as those of a mesh in memory do (mesh_input.h).
// InputError, before the table is written, where the triangles of one brick are too many; it says
// what run.memory would do.
void bin_mesh(const SpooledMesh& mesh, const MeshBinning& binning, const MeshWork& work,
              const BinLimits& limits);

// Where the mesh's coordinate is, in the frame of sample 0.
inline Vec3 in_frame(Vec3 place, const VolumeGeometry& geometry) {
  return place + (Vec3{} - geometry.first);
}

}  // namespace voxweld
