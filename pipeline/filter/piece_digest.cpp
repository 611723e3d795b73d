#include "pipeline/filter/piece_digest.h"

#include "storage/artifact/piece_changes.h"

namespace voxweld {
namespace {

void set_bit(std::vector<std::uint64_t>& bits, std::uint32_t i) {
  bits[i / 64] |= std::uint64_t{1} << (i % 64);
}

}  // namespace

BlockDigest digest_block(const PieceRule& rule, const BlockMask& mask, BlockLabels& labels,
                         const Box3& block, Index3 volume) {
  labels.find(mask);
  BlockDigest digest;
  digest.pieces = labels.pieces();
  if (digest.pieces == 0) return digest;
  BlockPieces found = describe_pieces(mask, labels, block, volume);
  digest.open.resize(piece_words(digest.pieces));
  digest.changes.resize(piece_words(digest.pieces));
  std::vector<std::uint32_t> node_of(digest.pieces);
  for (std::uint32_t i = 0; i < digest.pieces; ++i) {
    const PieceFacts& facts = found.facts[i];
    if (found.open[i] != 0) {
      set_bit(digest.open, i);
      node_of[i] = static_cast<std::uint32_t>(digest.nodes.size());
      digest.nodes.push_back(facts);
      continue;
    }
    if (digest.closed.judge(rule, facts)) set_bit(digest.changes, i);
    if (!keeps_largest(rule) || !is_larger(facts, digest.largest)) continue;
    digest.largest = facts;
    digest.largest_piece = i;
  }
  digest.faces = std::move(found.faces);
  for (FaceRuns& face : digest.faces)
    for (std::uint32_t& piece : face.pieces) piece = node_of[piece];
  return digest;
}

}  // namespace voxweld
