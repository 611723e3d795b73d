// How one unit of stitch is done, for tiles of one surface and for labels.
#pragma once

#include <array>
#include <memory>

#include "pipeline/stage/artifacts.h"
#include "pipeline/stage/context.h"
#include "stages/stitch/stitch_tile.h"
#include "storage/artifact/top_artifact.h"

namespace voxweld {

// A worker's brick and its neighbours' ghost layers, reused.
struct StitchScratch {
  BrickOctree brick;
  std::array<GhostLayer, 8> upper;
};

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

// Pieces that are read when they are asked for, into a worker's scratch; the worker is asked to
// stop before each brick.
class ReadPieces : public BrickPieces {
 public:
  ReadPieces(StitchScratch& scratch, const WorkerContext& worker)
      : scratch_(scratch), worker_(worker) {}

  const BrickOctree& brick(const CellKey& key) final;
  const GhostLayer* ghost(Index3 brick, int direction) final;

 private:
  virtual void read(const CellKey& brick, BrickOctree& out) = 0;
  // False where the brick has no surface.
  virtual bool read_ghost_layer(Index3 brick, GhostLayer& out) = 0;

  StitchScratch& scratch_;
  const WorkerContext& worker_;
};

}  // namespace voxweld
