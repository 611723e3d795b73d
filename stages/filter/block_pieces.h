// The connected pieces of one block's samples: those that hang together through faces of samples,
// within the block.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "stages/filter/block_mask.h"
#include "storage/types/box.h"

namespace voxweld {

// Consecutive samples of one row.
struct PieceRun {
  std::uint16_t row = 0;            // of the mask's rows
  std::uint8_t begin = 0, end = 0;  // samples [begin, end)
};

// Numbers a block's pieces from 0 in order of their first samples (by z, then y, then x). Keeps its
// memory from one block to the next: at most label_bytes.
class BlockLabels {
 public:
  void find(const BlockMask& mask);

  std::uint32_t pieces() const { return pieces_; }
  // f(run, piece), in order of the samples.
  template <class F>
  void each_run(F&& f) const {
    for (std::size_t i = 0; i < runs_.size(); ++i) f(runs_[i], piece_[i]);
  }

 private:
  void add_runs(std::size_t row, std::uint64_t bits);
  void link(std::size_t row, std::size_t earlier);
  std::uint32_t root(std::uint32_t run);
  void number();

  std::vector<PieceRun> runs_;
  std::vector<std::uint32_t> piece_;  // of each run; before they are numbered, an earlier run of it
  std::vector<std::uint32_t> first_;  // run of each row, and one past the last
  std::uint32_t pieces_ = 0;
};
inline constexpr std::uint64_t most_block_runs =
    most_block_side * most_block_side * most_block_side / 2;
inline constexpr std::uint64_t label_bytes =
    most_block_runs * 16 + most_block_side * most_block_side * 16;  // as vectors grow

struct PieceFacts {
  std::uint64_t samples = 0;
  std::uint64_t first = ~std::uint64_t{0};  // its first sample: x + size.x * (y + size.y * z)
  bool border = false;                      // it reaches the border of the volume
  friend bool operator==(const PieceFacts&, const PieceFacts&) = default;
};
// Of two that are one.
constexpr PieceFacts merge(const PieceFacts& a, const PieceFacts& b) {
  return {a.samples + b.samples, a.first < b.first ? a.first : b.first, a.border || b.border};
}

// What of the pieces lies on one face of a block. Its rows run along x; along y on a face across x.
// Empty where nothing does.
struct FaceRuns {
  std::vector<std::uint64_t> rows;    // a bit a sample
  std::vector<std::uint32_t> pieces;  // of each run of bits, row by row
};
constexpr int face_of(int axis, bool high) {
  return 2 * axis + (high ? 1 : 0);
}
using BlockFaces = std::array<FaceRuns, 6>;  // by face_of; those inside the volume alone

struct BlockPieces {
  std::vector<PieceFacts> facts;
  std::vector<std::uint8_t> open;  // whether the piece reaches a face inside the volume
  BlockFaces faces;
};
// labels: found of `mask`, which are the samples of `block`.
BlockPieces describe_pieces(const BlockMask& mask, const BlockLabels& labels, const Box3& block,
                            Index3 volume);

}  // namespace voxweld
