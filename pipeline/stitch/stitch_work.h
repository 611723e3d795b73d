// How one unit of stitch is done: a tile of one material, or some small labels one after the other.
#pragma once

#include <optional>

#include "pipeline/stitch/tile_inputs.h"
#include "stages/refine/cube_lattice.h"

namespace voxweld {

class StitchWork {
 public:
  // Both outlive it. top: the job's.
  StitchWork(const StitchJob& job, const TopArtifact& top);

  // Of the unit's artifact, from the inputs that lie there now. Thread-safe.
  Hash128 key(std::uint64_t unit);
  // Of an artifact that lies there.
  Hash128 key_of(const std::filesystem::path& path) const;
  // Bytes that it holds for all units.
  std::uint64_t bytes() const { return of_labels_ ? 0 : top_.cluster_bytes(0); }
  // Bytes that the bricks it reads take at most, beside the mesh: one of them, and its neighbours'
  // ghost layers.
  std::uint64_t brick_bytes(std::uint64_t unit) const { return 2 * batches_[unit].largest_piece; }
  // Reads, stitches and writes the artifact.
  void run(std::uint64_t unit, const std::filesystem::path& path, StitchScratch& scratch,
           WorkerContext& worker);

 private:
  // number: of the surface, among all.
  TileInputs inputs_of(std::uint64_t number, const SurfaceRecord& surface, const PlannedTile& tile,
                       MaterialPieces& pieces);
  Hash128 key_of_labels(std::uint64_t unit) const;
  template <class F>
  void each_tile(std::uint64_t unit, F&& f) const;
  template <class F>
  void each_mesh(std::uint64_t unit, StitchScratch& scratch, WorkerContext& worker, F&& f);

  const StitchJob& job_;
  const bool of_labels_;
  MaterialTop top_;
  std::vector<BatchRecord> batches_;
  ShardFiles files_;
  BoundedCache<ReducedNode> clusters_{1};  // of a surface
  std::optional<CubeLattice> cubes_;       // where the meshes are refined
};

}  // namespace voxweld
