// The pieces of a run of bricks in memory, as they come into the shard's artifact later.
#pragma once

#include <memory>
#include <vector>

#include "pipeline/build/brick_octrees.h"
#include "storage/artifact/brick_pieces.h"
#include "storage/artifact/brick_ranges_artifact.h"
#include "storage/artifact/shard_summary.h"
#include "storage/types/nan_count.h"

namespace voxweld {

// Bricks along x that are read together.
struct BrickRow {
  Index3 first;
  std::int64_t count = 0;
  Box3 samples;
};

struct PiecesOfBrick {
  BuiltBrick built;
  bool surface = false;            // of a material that does not fill the brick
  std::vector<std::byte> section;  // of the artifact; empty where the brick is outside
  struct Note {
    PieceKey key;
    std::vector<std::byte> bytes;  // piece_note.h
  };
  std::vector<Note> notes;
};

struct RunPieces {
  BuiltRun built;
  std::vector<PiecesOfBrick> bricks;
  NanCount nans;                     // among the run's own samples
  std::vector<BrickRange> ranges;    // of the bricks
  std::unique_ptr<MemoryLoan> loan;  // what all this takes
};

// Brings pieces there.
class RunPiecesSink final : public BrickSink {
 public:
  RunPiecesSink(const BuildJob& job, RunPieces& out) : job_(job), out_(out) {}

  void begin_brick(Index3 brick) override;
  void put(Material material, const BrickOctree& octree) override;
  void end_brick() override {}
  std::uint64_t bytes_held() const override { return bytes_; }

 private:
  const BuildJob& job_;
  RunPieces& out_;
  AboveBytes above_;
  std::uint64_t bytes_ = 0;
};

}  // namespace voxweld
