// What a pass over the volume learns of its pieces, on disk, until it is known what becomes of each:
// written layer by layer, read from the last layer to the first.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "pipeline/executor/interrupt.h"
#include "pipeline/filter/piece_digest.h"
#include "stages/filter/piece_join.h"
#include "storage/artifact/piece_changes.h"
#include "storage/support/run_file.h"

namespace voxweld {

// Where a piece became complete: within a block, or as a group of a layer.
struct PiecePlace {
  std::uint64_t layer = 0;
  std::optional<std::uint64_t> block;  // counted through the volume
  std::uint32_t number = 0;            // of the block's piece, or of the layer's group
};

class PieceLedger {
 public:
  // folder: of the scratch files.
  explicit PieceLedger(const std::filesystem::path& folder) : blocks_(folder), groups_(folder) {}

  void add_block(const BlockDigest& digest);
  // changes: of each group that is complete whether it changes.
  void end_layer(const JoinedLayer& layer, const std::vector<std::uint8_t>& changes);
  // Writes what becomes of each block. spared: the piece that does not change though it was said to.
  void write(const std::optional<PiecePlace>& spared, PieceChangesWriter& out,
             const InterruptFlag* interrupt) const;

 private:
  struct Layer {
    RunExtent blocks, groups;
    std::uint64_t nodes = 0, group_count = 0, carried = 0, block_count = 0;
  };
  struct Verdicts;
  Verdicts read_verdicts(const Layer& layer, const std::vector<std::uint8_t>& carried_on,
                         std::optional<std::uint32_t> spared) const;
  void write_layer(std::size_t number, std::uint64_t first_block, const Verdicts& verdicts,
                   const std::optional<PiecePlace>& spared, PieceChangesWriter& out) const;

  RunFile blocks_, groups_;
  std::uint64_t block_count_ = 0;  // of the layer under way
  std::vector<Layer> layers_;
};

}  // namespace voxweld
