#include "pipeline/build/run_pieces.h"

#include "pipeline/build/piece_note.h"
#include "stages/merge/shard_reduction.h"

namespace voxweld {

void RunPiecesSink::begin_brick(Index3 brick) {
  out_.bricks.emplace_back().built = {morton_encode(brick), brick_key(job_, brick), {}};
}

void RunPiecesSink::put(Material material, const BrickOctree& octree) {
  PiecesOfBrick& brick = out_.bricks.back();
  add_brick(brick.built.counts, octree.counts, octree.root.state);
  if (octree.root.state == NodeState::outside) return;
  const std::vector<FilledBlock> blocks = filled_blocks(octree.blocks);
  put_above(octree, above_);
  const std::size_t before = brick.section.size();
  const PieceHead head =
      append_piece({material, brick.built.code}, octree, blocks, above_, brick.section);
  brick.surface = brick.surface || has_surface(head);
  PiecesOfBrick::Note& note = brick.notes.emplace_back();
  note.key = head.piece.key;
  put_note(head, blocks, above_.record(), note.bytes);
  // Vectors may have grown to twice their content.
  bytes_ += 2 * (brick.section.size() - before + note.bytes.size() + sizeof note);
}

}  // namespace voxweld
