#include "stages/refine/box_pairs.h"

namespace voxweld {

BoxPairs::BoxPairs(const std::vector<LatticeBox>& boxes) {
  if (boxes.empty()) {
    levels_.resize(1);
    return;
  }
  LatticeBox all = boxes.front();
  for (const LatticeBox& box : boxes) all.extend(box);
  const BoxPacker pack(all);
  std::vector<PackedBox> packed;
  packed.reserve(boxes.size());
  for (const LatticeBox& box : boxes) packed.emplace_back(pack, box, 0);
  do {  // once more than down to one group, so that each has a box around it
    std::vector<Eight>& level = levels_.emplace_back();
    level.resize((packed.size() + branches - 1) / branches);
    std::vector<PackedBox> around;
    for (std::size_t g = 0; g < level.size(); ++g)
      for (EightShorts& end : level[g].ends) end = EightShorts{} + INT16_MAX;  // none
    for (std::size_t i = 0; i < packed.size(); ++i) {
      for (std::size_t k = 0; k < 6; ++k)
        level[i / branches].ends[k][i % branches] = packed[i].lanes[k];
      if (i % branches == 0)
        around.push_back(packed[i]);
      else
        around.back().extend(packed[i]);
    }
    packed = std::move(around);
  } while (levels_.back().size() > 1 || levels_.size() == 1);
}

}  // namespace voxweld
