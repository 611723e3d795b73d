// The finest cells with a sign change, in Morton order.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "stages/build/label_grid.h"
#include "stages/build/sign_grid.h"
#include "storage/types/brick_octree.h"
#include "storage/types/morton.h"

namespace voxweld {

// Morton arithmetic inside a brick: codes of 24 bits, x in bits 0, 3, 6 ...
inline constexpr std::uint32_t morton_axis_mask[3] = {0x249249, 0x492492, 0x924924};

struct LocalCell {
  int x = 0, y = 0, z = 0;
  int operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
};
LocalCell decode_local(std::uint32_t code);

// The code one cell further along `axis`, wrapping at 256.
constexpr std::uint32_t next_along(std::uint32_t code, int axis) {
  const std::uint32_t mask = morton_axis_mask[axis];
  return (((code | ~mask) + 1) & mask) | (code & ~mask & 0xffffff);
}

class ActiveCells {
 public:
  // How many there are, before anything is allocated for them; then find() lists them.
  // where: of cells relative to the brick, those that may have a sign change; no other is looked
  // at.
  std::size_t count(const SignGrid& signs, int side, const Box3& where);
  void find(const SignGrid& signs);
  // The sheets of those that count() found, at most.
  std::size_t most_sheets(const SignGrid& signs) const;
  // Those whose corners are not all of one label. The sign bytes of cells of two labels have the
  // smaller one inside; those of more labels are of no meaning.
  std::size_t count(const LabelGrid& labels);
  void find(const LabelGrid& labels);
  // Gives the lists' memory back; what count() found stays.
  void free_lists();

  std::size_t size() const { return codes_.size(); }
  std::uint32_t code(std::size_t i) const { return codes_[i]; }
  LocalCell at(std::size_t i) const {
    const std::uint32_t p = places_[i];
    return {static_cast<int>(p & 255), static_cast<int>(p >> 8 & 255), static_cast<int>(p >> 16)};
  }
  CellSigns signs(std::size_t i) const { return signs_[i]; }
  bool joined(std::size_t i) const { return joined_[i] == 1; }
  const CellSheets& sheets(std::size_t i) const {
    if (joined_[i] == of_several_labels) return several_[several_before(i)].sheets;
    return cell_sheets(signs_[i], joined_[i] != 0);
  }
  // Whether the cell may take part in a safe collapse.
  bool collapses(std::size_t i) const {
    if (joined_[i] == of_several_labels) return several_[several_before(i)].collapses;
    return collapsible(signs_[i]);
  }
  NormalSense normal_sense(std::size_t i) const {
    return joined_[i] == of_several_labels ? NormalSense::either : NormalSense::outward;
  }
  const std::vector<std::uint32_t>& codes() const { return codes_; }

  // The index of the active cell with this code. Precondition: it is active.
  std::size_t index_of(std::uint32_t code) const {
    const Block& block = blocks_[code >> 6];
    const std::uint64_t below = (std::uint64_t{1} << (code & 63)) - 1;
    return block.first + static_cast<std::size_t>(std::popcount(block.mask & below));
  }

 private:
  void begin(int side, const Box3& where);
  template <class F>
  void each_word(const F& f) const;
  std::size_t count_rows() const;
  void find_rows(const SignGrid& signs);
  void find_rows(const LabelGrid& labels);
  // add(code, place) of every active cell, in Morton order.
  template <class Add>
  void each_active(CellKey blocks, const Add& add);
  template <class Add>
  void each_active(const Add& add);
  std::uint64_t block_mask(int bx, int by, int bz) const;
  void add_cell(const SignGrid& signs, std::uint32_t code, LocalCell c);
  void add_cell(const LabelGrid& labels, std::uint32_t code, LocalCell c);
  void add_cell(std::uint32_t code, LocalCell c, CellSigns signs, std::uint8_t joined);

  // A cell of three or more labels.
  static constexpr std::uint8_t of_several_labels = 2;
  struct Several {
    std::uint32_t cell = 0;
    bool collapses = false;
    CellSheets sheets;
  };
  std::size_t several_before(std::size_t cell) const;

  // 4^3 cells: a bit each in Morton order, and how many active cells come before.
  struct Block {
    std::uint64_t mask = 0;
    std::size_t first = 0;
  };
  int side_ = 0;
  Box3 window_;  // cells looked at: whole blocks
  std::size_t row_words_ = 0;
  std::vector<std::uint64_t> rows_;  // active bits, a row for each (y, z) of the window
  std::vector<Block> blocks_;        // those of the window are of this brick
  std::vector<std::uint32_t> codes_;
  std::vector<std::uint32_t> places_;  // x | y << 8 | z << 16: decoded once
  std::vector<CellSigns> signs_;
  std::vector<std::uint8_t> joined_;  // 0, 1, or of_several_labels
  std::vector<Several> several_;      // ascending cell
};

}  // namespace voxweld
