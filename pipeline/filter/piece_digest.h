// What is left of a block once its pieces are found: all that putting it together with others needs.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/filter/piece_verdict.h"
#include "stages/filter/block_pieces.h"

namespace voxweld {

struct BlockDigest {
  std::uint32_t pieces = 0;
  // A bit a piece: whether it reaches a face inside the volume, and where not, whether it changes.
  std::vector<std::uint64_t> open, changes;
  std::vector<PieceFacts> nodes;  // the open ones
  BlockFaces faces;               // by number of node
  PieceTally closed;              // the others
  PieceFacts largest;             // of these, where one is kept alone
  std::uint32_t largest_piece = 0;
};

// At most, in bytes: of a checkerboard.
inline constexpr std::uint64_t most_digest_bytes =
    2 * most_block_runs / 8 +                                               // bits
    3 * most_block_side * most_block_side * (sizeof(PieceFacts) + 4 + 4) +  // nodes, on six faces
    6 * most_block_side * 8;
// What finding it takes besides.
inline constexpr std::uint64_t digest_scratch_bytes =
    label_bytes + most_block_runs * (sizeof(PieceFacts) + 5);

BlockDigest digest_block(const PieceRule& rule, const BlockMask& mask, BlockLabels& labels,
                         const Box3& block, Index3 volume);

}  // namespace voxweld
