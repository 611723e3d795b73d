// A mesh that lies in bins on disk, as a solid: the pieces that bricks ask for answer.
#pragma once

#include <mutex>
#include <optional>

#include "pipeline/solids/mesh_binning.h"
#include "stages/solids/lattice_solid.h"
#include "storage/support/bounded_cache.h"

namespace voxweld {

// Nothing is read before something is asked. Asking throws DamagedArtifact for bins that fail their
// checks, StorageError for those that cannot be read.
class BinnedMesh final : public LatticeSolid {
 public:
  static constexpr std::size_t open_shards = 16;

  // bounds: as those of MeshSolid, of the whole mesh.
  BinnedMesh(MeshBinning binning, const Bounds& bounds)
      : binning_(std::move(binning)), bounds_(bounds) {}

  const Bounds& bounds() const override { return bounds_; }
  Hash128 source() const override { return binning_.source; }
  // These two read a brick's bin each time they are asked.
  void each_flip(const Box3& samples, const std::function<void(const Flip&)>& flip) const override;
  Crossing crossing(int axis, Index3 s, bool low_inside) const override;

  // samples: MeshBinning::samples_of a brick, or some of them.
  std::optional<bool> side(const Box3& samples) const override;
  std::shared_ptr<const LatticeSolid> near(const Box3& samples) const override;

 private:
  const MeshTable& table() const;
  Index3 brick_with(const Box3& samples) const;
  // Null where its shard has no bins.
  std::shared_ptr<const MeshBins> bins_of(Index3 brick) const;
  MeshSide side_of(Index3 brick, const MeshBins* bins) const;

  MeshBinning binning_;
  Bounds bounds_;
  mutable std::mutex mutex_;
  mutable std::optional<MeshTable> table_;
  mutable BoundedCache<MeshBins> shards_{open_shards};
};

}  // namespace voxweld
