#include "stages/build/label_bricks.h"

namespace voxweld {

const BrickOctree& filled_brick() {
  static const BrickOctree brick = [] {
    BrickOctree filled;
    filled.root.state = NodeState::inside;
    filled.root.corner_signs = 255;
    return filled;
  }();
  return brick;
}

void LabelBricks::each(const BrickPlace& place, const ContourParameters& parameters,
                       const std::function<void(Material, const BrickOctree&)>& f) {
  const HaloBlock& block = materials_.block();
  const auto labels = static_cast<std::uint32_t>(materials_.materials().size());
  ContourParameters of_label = parameters;
  for (const std::uint32_t label : extents_.find(block, place, labels, materials_.outside())) {
    const Material material = materials_.materials()[label];
    if (extents_.everywhere(label)) {
      f(material, filled_brick());
      continue;
    }
    of_label.surface.label = label;
    build_brick(block, place, extents_.samples(label), of_label, scratch_, brick_);
    f(material, brick_);
  }
}

std::uint64_t LabelBricks::memory_bytes(std::uint64_t samples) {
  // Of MaterialBlock: the number of each sample, and of each value an entry of the table and of
  // three lists that may have grown to twice their content.
  constexpr std::uint64_t of_value = 48 + 2 * (8 + 8 + 4);
  return samples * (sizeof(std::uint32_t) + of_value) + LabelExtents::memory_bytes(samples);
}

}  // namespace voxweld
