// The pass over a volume that finds its pieces.
#pragma once

#include <optional>

#include "pipeline/filter/piece_ledger.h"
#include "pipeline/stage/context.h"
#include "storage/types/volume.h"

namespace voxweld {

struct FoundPieces {
  PieceTally tally;
  StoredRange range;                 // of all samples
  std::optional<PiecePlace> spared;  // the largest, where that one is kept
};

// Reads everything once, in blocks of `side` samples a side; `ledger` then knows them.
// Runs on context.executor, which is one of this process. Throws as find_pieces does.
FoundPieces pass_over_pieces(RunContext& context, const SampleSource& source, const PieceRule& rule,
                             std::int64_t side, PieceLedger& ledger);

// find_pieces with blocks of another size.
void find_pieces_in_blocks(RunContext& context, const SampleSource& source, const PieceRule& rule,
                           const std::filesystem::path& path, Hash128 key, std::int64_t side);

}  // namespace voxweld
