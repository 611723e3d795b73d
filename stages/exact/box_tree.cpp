#include "stages/exact/box_tree.h"

#include <numeric>

#include "storage/types/morton.h"

namespace voxweld {
namespace {

std::uint64_t place(const LatticeBox& box) {
  // 22 bits, of which Morton codes take 21: half of the sum of both ends, and half of that.
  const auto middle = [&](std::size_t axis) {
    return (std::int64_t{box.lo[axis]} + box.hi[axis]) / 4;
  };
  return morton_encode({middle(0), middle(1), middle(2)});
}

}  // namespace

BoxTree::BoxTree(const std::vector<LatticeBox>& boxes) {
  if (boxes.empty()) return;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> places;
  places.reserve(boxes.size());
  for (const LatticeBox& box : boxes)
    places.emplace_back(place(box), static_cast<std::uint32_t>(places.size()));
  std::ranges::sort(places);
  std::vector<LatticeBox> sorted;
  sorted.reserve(boxes.size());
  order_.reserve(boxes.size());
  for (const auto& [code, number] : places) {
    order_.push_back(number);
    sorted.push_back(boxes[number]);
  }
  levels_.push_back(std::move(sorted));
  while (levels_.back().size() > 1) {
    const std::vector<LatticeBox>& below = levels_.back();
    std::vector<LatticeBox> level;
    level.reserve(below.size() / branches + 1);
    for (std::size_t i = 0; i < below.size(); ++i)
      if (i % branches == 0)
        level.push_back(below[i]);
      else
        level.back().extend(below[i]);
    levels_.push_back(std::move(level));
  }
}

}  // namespace voxweld
