// How one unit of stitch is done, for tiles of one surface and for labels.
#pragma once

#include "pipeline/stitch/tile_pieces.h"

namespace voxweld {

class StitchWork {
 public:
  // job: outlives it.
  explicit StitchWork(const StitchJob& job) : job_(job) {}
  virtual ~StitchWork() = default;
  // Of the unit's artifact, from the inputs that lie there now. Thread-safe.
  virtual Hash128 key(std::uint64_t unit) = 0;
  // Of an artifact that lies there.
  Hash128 key_of(const std::filesystem::path& path) const;
  // Bytes that it holds for all units.
  virtual std::uint64_t bytes() const { return 0; }
  // Bytes that the bricks it reads take at most, beside the mesh.
  virtual std::uint64_t brick_bytes(std::uint64_t unit) = 0;
  // Reads, stitches and writes the artifact.
  virtual void run(std::uint64_t unit, const std::filesystem::path& path, StitchScratch& scratch,
                   WorkerContext& worker) = 0;

 protected:
  const StitchJob& job_;
};

// The one for labels.mode of the job. top: the job's, outlives it.
std::unique_ptr<StitchWork> stitch_work(const StitchJob& job, const TopArtifact& top);

}  // namespace voxweld
