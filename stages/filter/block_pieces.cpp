#include "stages/filter/block_pieces.h"

#include <bit>

namespace voxweld {

void BlockLabels::find(const BlockMask& mask) {
  runs_.clear();
  piece_.clear();
  first_.assign(1, 0);
  const auto slice = static_cast<std::size_t>(mask.size.y);
  for (std::size_t row = 0; row < mask.rows.size(); ++row) {
    const std::uint64_t bits = mask.rows[row];
    add_runs(row, bits);
    if (bits == 0) continue;
    if (row % slice != 0 && (bits & mask.rows[row - 1]) != 0) link(row, row - 1);
    if (row >= slice && (bits & mask.rows[row - slice]) != 0) link(row, row - slice);
  }
  number();
}

void BlockLabels::add_runs(std::size_t row, std::uint64_t bits) {
  while (bits != 0) {
    const int begin = std::countr_zero(bits);
    const int end = begin + std::countr_one(bits >> begin);
    piece_.push_back(static_cast<std::uint32_t>(runs_.size()));
    runs_.push_back({static_cast<std::uint16_t>(row), static_cast<std::uint8_t>(begin),
                     static_cast<std::uint8_t>(end)});
    bits = end == most_block_side ? 0 : bits >> end << end;
  }
  first_.push_back(static_cast<std::uint32_t>(runs_.size()));
}

// The runs of both rows that overlap are of one piece.
void BlockLabels::link(std::size_t row, std::size_t earlier) {
  std::uint32_t a = first_[row], b = first_[earlier];
  const std::uint32_t a_end = first_[row + 1], b_end = first_[earlier + 1];
  while (a < a_end && b < b_end) {
    if (runs_[a].begin < runs_[b].end && runs_[b].begin < runs_[a].end) {
      const std::uint32_t root_a = root(a), root_b = root(b);
      // The first run stands for the piece.
      piece_[std::max(root_a, root_b)] = std::min(root_a, root_b);
    }
    if (runs_[a].end < runs_[b].end)
      ++a;
    else
      ++b;
  }
}

std::uint32_t BlockLabels::root(std::uint32_t run) {
  while (piece_[run] != run) {
    piece_[run] = piece_[piece_[run]];
    run = piece_[run];
  }
  return run;
}

void BlockLabels::number() {
  pieces_ = 0;
  for (std::uint32_t i = 0; i < piece_.size(); ++i)  // the run it names has its number already
    piece_[i] = piece_[i] == i ? pieces_++ : piece_[piece_[i]];
}

namespace {

// The faces of one block, as its runs are gone through in order.
class FaceWriter {
 public:
  FaceWriter(const BlockMask& mask, const Box3& block, Index3 volume, BlockPieces& out)
      : size_(mask.size), out_(out) {
    for (int axis = 0; axis < 3; ++axis) {
      outer_[face_at(axis, false)] = block.lo[axis] == 0;
      outer_[face_at(axis, true)] = block.hi[axis] == volume[axis];
    }
  }

  void add(const PieceRun& run, std::uint32_t piece) {
    const std::int64_t y = run.row % size_.y, z = run.row / size_.y;
    const std::uint64_t bits = ~std::uint64_t{0} >> (most_block_side - (run.end - run.begin))
                                                        << run.begin;
    if (run.begin == 0) add_sample(face_of(0, false), y, z, piece);
    if (run.end == size_.x) add_sample(face_of(0, true), y, z, piece);
    if (y == 0) add_run(face_of(1, false), z, size_.z, bits, piece);
    if (y + 1 == size_.y) add_run(face_of(1, true), z, size_.z, bits, piece);
    if (z == 0) add_run(face_of(2, false), y, size_.y, bits, piece);
    if (z + 1 == size_.z) add_run(face_of(2, true), y, size_.y, bits, piece);
  }

 private:
  static std::size_t face_at(int axis, bool high) {
    return static_cast<std::size_t>(face_of(axis, high));
  }

  // The face's row, where the face is one inside the volume.
  std::uint64_t* reach(int face, std::int64_t row, std::int64_t rows, std::uint32_t piece) {
    if (outer_[static_cast<std::size_t>(face)]) {
      out_.facts[piece].border = true;
      return nullptr;
    }
    out_.open[piece] = 1;
    std::vector<std::uint64_t>& words = out_.faces[static_cast<std::size_t>(face)].rows;
    if (words.empty()) words.resize(static_cast<std::size_t>(rows));
    return &words[static_cast<std::size_t>(row)];
  }
  void add_run(int face, std::int64_t row, std::int64_t rows, std::uint64_t bits,
               std::uint32_t piece) {
    std::uint64_t* word = reach(face, row, rows, piece);
    if (word == nullptr) return;
    *word |= bits;
    out_.faces[static_cast<std::size_t>(face)].pieces.push_back(piece);
  }
  // Samples side by side along y are of one piece: one run.
  void add_sample(int face, std::int64_t y, std::int64_t z, std::uint32_t piece) {
    std::uint64_t* word = reach(face, z, size_.z, piece);
    if (word == nullptr) return;
    const bool goes_on = y > 0 && (*word >> (y - 1) & 1) != 0;
    *word |= std::uint64_t{1} << y;
    if (!goes_on) out_.faces[static_cast<std::size_t>(face)].pieces.push_back(piece);
  }

  Index3 size_;
  BlockPieces& out_;
  std::array<bool, 6> outer_{};  // faces at the volume's border
};

}  // namespace

BlockPieces describe_pieces(const BlockMask& mask, const BlockLabels& labels, const Box3& block,
                            Index3 volume) {
  BlockPieces out;
  out.facts.resize(labels.pieces());
  out.open.resize(labels.pieces());
  FaceWriter faces(mask, block, volume, out);
  labels.each_run([&](const PieceRun& run, std::uint32_t piece) {
    PieceFacts& facts = out.facts[piece];
    facts.samples += static_cast<std::uint64_t>(run.end - run.begin);
    if (facts.first == PieceFacts{}.first) {
      const Index3 at = block.lo + Index3{run.begin, run.row % mask.size.y, run.row / mask.size.y};
      facts.first = static_cast<std::uint64_t>(at.x + volume.x * (at.y + volume.y * at.z));
    }
    faces.add(run, piece);
  });
  return out;
}

}  // namespace voxweld
