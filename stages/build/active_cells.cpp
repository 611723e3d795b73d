#include "stages/build/active_cells.h"

#include <algorithm>
#include <array>

namespace voxweld {

LocalCell decode_local(std::uint32_t code) {
  using morton_detail::gather;
  return {static_cast<int>(gather(code)), static_cast<int>(gather(code >> 1)),
          static_cast<int>(gather(code >> 2))};
}

namespace {

// The cell with this Morton code inside a block of 4^3.
constexpr LocalCell place_in_block(std::uint32_t code) {
  const auto pair = [&](int axis) {
    return static_cast<int>((code >> axis & 1) | (code >> (3 + axis) & 1) << 1);
  };
  return {pair(0), pair(1), pair(2)};
}

}  // namespace

void ActiveCells::begin(int side, const Box3& where) {
  side_ = side;
  row_words_ = static_cast<std::size_t>(side_ + 63) / 64;
  rows_.resize(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_) * row_words_);
  const auto across = static_cast<std::size_t>(side / 4);
  blocks_.resize(across * across * across);
  window_ = intersect(where, Box3{{}, splat(side)});
  if (window_.empty()) window_ = {};
  for (int a = 0; a < 3; ++a) {
    window_.lo[a] &= ~std::int64_t{3};
    window_.hi[a] = (window_.hi[a] + 3) & ~std::int64_t{3};
  }
}

void ActiveCells::free_lists() {
  codes_ = {};
  places_ = {};
  signs_ = {};
  joined_ = {};
  several_ = {};
}

// f(x, y, z, bits) of each word of the window's rows: bit i is cell x + i.
template <class F>
void ActiveCells::each_word(const F& f) const {
  for (auto z = window_.lo.z; z < window_.hi.z; ++z)
    for (auto y = window_.lo.y; y < window_.hi.y; ++y) {
      const std::uint64_t* row =
          rows_.data() + static_cast<std::size_t>(z * side_ + y) * row_words_;
      for (std::size_t w = 0; w < row_words_; ++w)
        f(static_cast<int>(w) * 64, static_cast<int>(y), static_cast<int>(z), row[w]);
    }
}

std::size_t ActiveCells::count_rows() const {
  std::size_t count = 0;
  each_word([&](int, int, int, std::uint64_t bits) {
    count += static_cast<std::size_t>(std::popcount(bits));
  });
  return count;
}

template <class Add>
void ActiveCells::each_active(const Add& add) {
  codes_.clear();
  places_.clear();
  signs_.clear();
  joined_.clear();
  several_.clear();
  each_active({std::countr_zero(static_cast<unsigned>(side_)) - 2, {}}, add);
}

// In a cube of blocks: those of the window, in Morton order.
template <class Add>
void ActiveCells::each_active(CellKey blocks, const Add& add) {
  const Box3 cells{blocks.lo() * 4, (blocks.lo() + splat(blocks.side())) * 4};
  if (intersect(cells, window_).empty()) return;
  if (blocks.level > 0) {
    for (int octant = 0; octant < 8; ++octant) each_active(blocks.child(octant), add);
    return;
  }
  const auto b = static_cast<std::uint32_t>(morton_encode(blocks.at));
  const LocalCell at{static_cast<int>(blocks.at.x), static_cast<int>(blocks.at.y),
                     static_cast<int>(blocks.at.z)};
  Block& block = blocks_[b];
  block.first = codes_.size();
  block.mask = block_mask(at.x, at.y, at.z);
  for (std::uint64_t rest = block.mask; rest != 0; rest &= rest - 1) {
    const auto inside = static_cast<std::uint32_t>(std::countr_zero(rest));
    const LocalCell in = place_in_block(inside);
    add(b << 6 | inside, LocalCell{at.x * 4 + in.x, at.y * 4 + in.y, at.z * 4 + in.z});
  }
}

std::size_t ActiveCells::count(const SignGrid& signs, int side, const Box3& where) {
  begin(side, where);
  if (signs.is_uniform()) {  // most bricks of most volumes
    std::ranges::fill(rows_, 0);
    return 0;
  }
  find_rows(signs);
  return count_rows();
}

std::size_t ActiveCells::most_sheets(const SignGrid& signs) const {
  std::size_t count = 0;
  each_word([&](int x, int y, int z, std::uint64_t bits) {
    for (; bits != 0; bits &= bits - 1)
      count += static_cast<std::size_t>(
          voxweld::most_sheets(signs.cell(x + std::countr_zero(bits), y, z)));
  });
  return count;
}

void ActiveCells::find(const SignGrid& signs) {
  each_active([&](std::uint32_t code, LocalCell c) { add_cell(signs, code, c); });
}

std::size_t ActiveCells::count(const LabelGrid& labels) {
  begin(labels.side(), Box3{{}, splat(labels.side())});
  find_rows(labels);
  return count_rows();
}

void ActiveCells::find(const LabelGrid& labels) {
  each_active([&](std::uint32_t code, LocalCell c) { add_cell(labels, code, c); });
}

// A cell is active unless its eight corners agree: or and and of four rows and of neighbouring
// bits.
void ActiveCells::find_rows(const SignGrid& signs) {
  const auto y0 = static_cast<int>(window_.lo.y), y1 = static_cast<int>(window_.hi.y);
  const auto z0 = static_cast<int>(window_.lo.z), z1 = static_cast<int>(window_.hi.z);
  for (int z = z0; z < z1; ++z)
    for (int y = y0; y < y1; ++y)
      for (std::size_t w = 0; w < row_words_; ++w) {
        const std::uint64_t* rows[4] = {signs.row(y, z) + w, signs.row(y + 1, z) + w,
                                        signs.row(y, z + 1) + w, signs.row(y + 1, z + 1) + w};
        std::uint64_t any[2] = {0, 0}, all[2] = {~std::uint64_t{0}, ~std::uint64_t{0}};
        for (const std::uint64_t* row : rows)
          for (int k = 0; k < 2; ++k) {
            any[k] |= row[k];
            all[k] &= row[k];
          }
        // Bit i of a sign row is x = i - 1: cell x needs bits x + 1 and x + 2.
        const std::uint64_t any1 = any[0] >> 1 | any[1] << 63, any2 = any[0] >> 2 | any[1] << 62;
        const std::uint64_t all1 = all[0] >> 1 | all[1] << 63, all2 = all[0] >> 2 | all[1] << 62;
        std::uint64_t active = (any1 | any2) & ~(all1 & all2);
        if (side_ < 64) active &= (std::uint64_t{1} << side_) - 1;
        rows_[static_cast<std::size_t>(z * side_ + y) * row_words_ + w] = active;
      }
}

void ActiveCells::find_rows(const LabelGrid& labels) {
  const auto points = static_cast<std::size_t>(side_) + 1;
  std::vector<std::uint8_t> same(points);  // the four points at this x are of one label
  std::uint64_t* out = rows_.data();
  for (int z = 0; z < side_; ++z)
    for (int y = 0; y < side_; ++y, out += row_words_) {
      const std::uint32_t* rows[4] = {labels.row(y, z), labels.row(y + 1, z), labels.row(y, z + 1),
                                      labels.row(y + 1, z + 1)};
      for (std::size_t x = 0; x < points; ++x)
        same[x] = rows[0][x] == rows[1][x] && rows[0][x] == rows[2][x] && rows[0][x] == rows[3][x];
      std::fill(out, out + row_words_, 0);
      for (std::size_t x = 0; x + 1 < points; ++x) {
        const bool active = !(same[x] && same[x + 1] && rows[0][x] == rows[0][x + 1]);
        out[x >> 6] |= std::uint64_t{active} << (x & 63);
      }
    }
}

std::uint64_t ActiveCells::block_mask(int bx, int by, int bz) const {
  // Four bits of a row to their places in Morton order; (y, z) shift them as a whole.
  static constexpr std::array<std::uint64_t, 16> spread = {0x000, 0x001, 0x002, 0x003, 0x100, 0x101,
                                                           0x102, 0x103, 0x200, 0x201, 0x202, 0x203,
                                                           0x300, 0x301, 0x302, 0x303};
  static constexpr std::array<int, 4> shift = {0, 2, 16, 18};
  const std::size_t word = static_cast<std::size_t>(bx) / 16;
  const int bit = bx % 16 * 4;
  std::uint64_t mask = 0;
  for (int z = 0; z < 4; ++z)
    for (int y = 0; y < 4; ++y) {
      const std::size_t row =
          static_cast<std::size_t>(bz * 4 + z) * static_cast<std::size_t>(side_) +
          static_cast<std::size_t>(by * 4 + y);
      const std::uint64_t four = rows_[row * row_words_ + word] >> bit & 15u;
      mask |= spread[four] << (shift[static_cast<std::size_t>(y)] +
                               2 * shift[static_cast<std::size_t>(z)]);
    }
  return mask;
}

void ActiveCells::add_cell(const SignGrid& signs, std::uint32_t code, LocalCell c) {
  const CellSigns own = signs.cell(c.x, c.y, c.z);
  bool joined = false;
  if (const int face = problem_face(own); face >= 0) {
    LocalCell n = c;
    (face < 2 ? n.x : face < 4 ? n.y : n.z) += (face & 1) != 0 ? 1 : -1;
    joined = joins_across(own, face, signs.cell(n.x, n.y, n.z));
  }
  add_cell(code, c, own, joined ? 1 : 0);
}

void ActiveCells::add_cell(std::uint32_t code, LocalCell c, CellSigns signs, std::uint8_t joined) {
  codes_.push_back(code);
  places_.push_back(static_cast<std::uint32_t>(c.x | c.y << 8 | c.z << 16));
  signs_.push_back(signs);
  joined_.push_back(joined);
}

void ActiveCells::add_cell(const LabelGrid& labels, std::uint32_t code, LocalCell c) {
  const CellLabels cell = labels.cell(c.x, c.y, c.z);
  const auto [low, high] = std::minmax_element(cell.begin(), cell.end());
  unsigned signs = 0, of_either = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    signs |= static_cast<unsigned>(cell[i] == *low) << i;
    of_either += cell[i] == *low || cell[i] == *high ? 1 : 0;
  }
  if (of_either < 8)
    several_.push_back(
        {static_cast<std::uint32_t>(codes_.size()), labels_collapsible(cell), label_sheets(cell)});
  add_cell(code, c, static_cast<CellSigns>(signs), of_either < 8 ? of_several_labels : 0);
}

std::size_t ActiveCells::several_before(std::size_t cell) const {
  const auto at = std::lower_bound(several_.begin(), several_.end(), cell,
                                   [](const Several& s, std::size_t c) { return s.cell < c; });
  return static_cast<std::size_t>(at - several_.begin());
}

}  // namespace voxweld
