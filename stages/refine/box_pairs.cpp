#include "stages/refine/box_pairs.h"

namespace voxweld {

BoxPairs::BoxPairs(const std::vector<LatticeBox>& boxes) {
  std::vector<Eight>& lowest = levels_.emplace_back((boxes.size() + branches - 1) / branches);
  if (boxes.empty()) return;
  LatticeBox all = boxes.front();
  for (const LatticeBox& box : boxes) all.extend(box);
  const BoxPacker pack(all);
  for (std::size_t i = 0; i < boxes.size(); ++i)
    for (std::size_t a = 0; a < 3; ++a) {
      Eight& eight = lowest[i / branches];
      eight.ends[a][i % branches] = pack(boxes[i].lo[a], a);
      eight.ends[a + 3][i % branches] = static_cast<std::int16_t>(-pack(boxes[i].hi[a], a));
    }
  do {  // once more than down to one group, so that each has a box around it
    const std::vector<Eight>& below = levels_.back();
    std::vector<Eight> level((below.size() + branches - 1) / branches);
    for (std::size_t n = 0; n < below.size(); ++n)
      for (std::size_t k = 0; k < 6; ++k)
        level[n / branches].ends[k][n % branches] = std::ranges::min(below[n].ends[k]);
    levels_.push_back(std::move(level));
  } while (levels_.back().size() > 1);
}

void BoxPairs::add_near(std::size_t level, std::size_t n, std::size_t block, const Most& most,
                        std::vector<std::size_t>& near) const {
  for (std::uint32_t bits = most.meeting(levels_[level][n]); bits != 0; bits &= bits - 1) {
    const std::size_t below = n * branches + static_cast<std::size_t>(std::countr_zero(bits));
    if ((below + 1) << (3 * (level - 2)) <= block) continue;
    if (level == 2)
      near.push_back(below);
    else
      add_near(level - 1, below, block, most, near);
  }
}

}  // namespace voxweld
