#include "stages/refine/triangle_grid.h"

namespace voxweld {
namespace {

// log2 of the size of bins of which no more than `side` cover the extent.
int shift_for(std::int32_t extent, std::int32_t side) {
  int shift = 0;
  while (extent >> shift >= side) ++shift;
  return shift;
}

}  // namespace

TriangleGrid::TriangleGrid(const LatticeBox& box, std::size_t triangles) : lo_(box.lo), pack_(box) {
  slots_.reserve(triangles);
  std::size_t first = 0, first_row = 0;
  for (std::int32_t side = triangles > 20000 ? most_side : 16; side >= 1; side /= 2) {
    Level level{side, {}, first, first_row, 0};
    for (std::size_t a = 0; a < 3; ++a) level.shift[a] = shift_for(box.hi[a] - box.lo[a], side);
    const auto bins = static_cast<std::size_t>(side);
    first += bins * bins * bins;
    first_row += bins * bins;
    levels_.push_back(level);
  }
  bins_.resize(first);
  rows_.resize(first_row);
}

// Whether the bin holds something, which has just changed or not.
void TriangleGrid::mark(const Level& level, std::uint32_t bin) {
  const std::size_t inside = bin - level.first, side = static_cast<std::size_t>(level.side);
  std::uint32_t& row = rows_[level.first_row + inside / side];
  const std::uint32_t bit = 1u << (inside % side);
  row = bins_[bin].empty() ? row & ~bit : row | bit;
}

std::size_t TriangleGrid::level_of(const LatticeBox& box) const {
  for (std::size_t l = 0; l + 1 < levels_.size(); ++l) {
    const std::array<int, 3>& shift = levels_[l].shift;
    if (box.hi[0] - box.lo[0] <= 1 << shift[0] && box.hi[1] - box.lo[1] <= 1 << shift[1] &&
        box.hi[2] - box.lo[2] <= 1 << shift[2])
      return l;
  }
  return levels_.size() - 1;
}

void TriangleGrid::put(std::uint32_t triangle, const LatticeBox& box) {
  if (triangle >= slots_.size()) slots_.resize(triangle + 1);
  Level& level = levels_[level_of(box)];
  const auto bin = static_cast<std::uint32_t>(number(level, place(level, box.lo)));
  const PackedBox packed(pack_, box, triangle);
  Slot& slot = slots_[triangle];
  if (bin == slot.bin) {
    bins_[bin][slot.place] = packed;
    return;
  }
  remove(triangle);
  slot = {bin, static_cast<std::uint32_t>(bins_[bin].size())};
  bins_[bin].push_back(packed);
  ++level.count;
  mark(level, bin);
}

void TriangleGrid::remove(std::uint32_t triangle) {
  const auto [bin, place] = slots_[triangle];
  if (bin == none) return;
  std::vector<PackedBox>& list = bins_[bin];
  list[place] = list.back();
  slots_[list[place].number()].place = place;
  list.pop_back();
  slots_[triangle].bin = none;
  for (std::size_t l = levels_.size(); l-- > 0;)
    if (bin >= levels_[l].first) {
      --levels_[l].count;
      mark(levels_[l], bin);
      break;
    }
}

}  // namespace voxweld
