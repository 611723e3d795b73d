#include "stages/build/label_bricks.h"

#include <algorithm>

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

void LabelBricks::fill(const HaloBlock& block, const ContourParameters& parameters) {
  given_.clear();
  for (const Edit& edit : parameters.edits)
    if (edit.material != exterior) given_.push_back(edit.material);
  materials_.fill(block, *parameters.labels.rules, given_);
}

void LabelBricks::find_labels(const BrickPlace& place, const ContourParameters& parameters) {
  const std::vector<Material>& materials = materials_.materials();
  const auto count = static_cast<std::uint32_t>(materials.size());
  labels_.clear();
  for (const std::uint32_t number :
       extents_.find(materials_.block(), place, count, materials_.outside()))
    labels_.push_back({number, true});
  edits_.clear();
  const Bounds bounds = brick_bounds(place, parameters.spacing);
  for (const Edit& edit : parameters.edits) {
    if (!edit_reaches(edit, bounds)) continue;
    edits_.push_back(&edit);
    if (edit.material == exterior) continue;
    const auto at = std::lower_bound(materials.begin(), materials.end(), edit.material);
    labels_.push_back({static_cast<std::uint32_t>(at - materials.begin()), false});
  }
  // Those found come before the same ones given.
  std::stable_sort(labels_.begin(), labels_.end(),
                   [](const Label& a, const Label& b) { return a.number < b.number; });
  const auto same = [](const Label& a, const Label& b) { return a.number == b.number; };
  labels_.erase(std::unique(labels_.begin(), labels_.end(), same), labels_.end());
}

void LabelBricks::each(const BrickPlace& place, const ContourParameters& parameters,
                       const std::function<void(Material, const BrickOctree&)>& f) {
  find_labels(place, parameters);
  solids_.begin(edits_, {materials_.block().size, parameters.spacing}, place.origin,
                1 << place.level);
  ContourParameters of_label{parameters.spacing, parameters.surface, {}, parameters.simplify, {}};
  for (const Label& label : labels_) {
    const Material material = materials_.materials()[label.number];
    const Box3 extent = label.found ? extents_.samples(label.number) : Box3{};
    LabelPart part(material, place, extent, edits_, solids_, parameters.spacing);
    if (label.found && extents_.everywhere(label.number) && !part.is_edited()) {
      f(material, filled_brick());
      continue;
    }
    if (part.replaces()) part.set_any(&materials_.any());
    of_label.surface.label = label.number;
    build_brick(materials_.block(), place, part, of_label, scratch_, brick_);
    f(material, brick_);
  }
}

std::uint64_t LabelBricks::memory_bytes(std::uint64_t samples) {
  // Of MaterialBlock: the number of each sample, and of each value an entry of the table and of
  // three lists that may have grown to twice their content; whether it is of any label. Of the
  // solids kept a bit each, in rows of whole words.
  constexpr std::uint64_t of_value = 48 + 2 * (8 + 8 + 4), of_solids = SolidSides::most_kept / 2;
  return samples * (sizeof(std::uint32_t) + of_value + 1 + of_solids) +
         LabelExtents::memory_bytes(samples);
}

}  // namespace voxweld
