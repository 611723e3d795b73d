#include "stages/build/label_part.h"

#include <algorithm>

namespace voxweld {
namespace {

bool gives(const Edit& edit, Material material) {
  return gives_material(edit.op) && edit.material == material;
}

// What no edit gives the label stays where it is.
BrickWindow window_of(Material material, const BrickPlace& place, const Box3& extent,
                      std::span<const Edit* const> edits) {
  const int side = 1 << place.level;
  const bool given = std::any_of(edits.begin(), edits.end(),
                                 [&](const Edit* edit) { return gives(*edit, material); });
  return given ? BrickWindow::everywhere(place.origin, side)
               : BrickWindow(place.origin, side, extent);
}

}  // namespace

LabelPart::LabelPart(Material material, const BrickPlace& place, const Box3& extent,
                     std::span<const Edit* const> edits, SolidSides& solids, Vec3 spacing)
    : material_(material),
      edits_(edits),
      solids_(&solids),
      window_(window_of(material, place, extent, edits)) {
  // A solid has a say where an edge begins or ends in the window.
  const VolumeFrame frame{{}, spacing};
  bounds_ = {frame.place_of_sample(window_.samples.lo - splat(1)),
             frame.place_of_sample(window_.samples.hi)};
  for (std::size_t i = 0; i < edits_.size(); ++i)
    if (op_of(*edits_[i]) == EditOp::replace) last_replace_ = i + 1;
}

EditOp LabelPart::op_of(const Edit& edit) const {
  if (!gives_material(edit.op)) return edit.op;
  return edit.material == material_ ? edit.op : EditOp::subtract;
}

bool LabelPart::changes(const Edit& edit) const {
  Edit own;
  own.op = op_of(edit);
  own.solid = edit.solid;
  return edit_reaches(own, bounds_);
}

bool LabelPart::is_edited() const {
  return std::any_of(edits_.begin(), edits_.end(),
                     [&](const Edit* edit) { return changes(*edit); });
}

bool LabelPart::apply_edits(const HaloBlock& block, const ContourParameters& parameters,
                            BrickSurface& surface, BrickSurface& any) const {
  const VolumeFrame frame{block.size, parameters.spacing};
  if (replaces()) {
    ContourParameters of_any = parameters;
    of_any.surface.label = 1;
    any.find_signs(*any_, window_, of_any.surface);
    any.find_edges(*any_, window_, of_any);
  }
  bool edited = false;
  for (std::size_t i = 0; i < edits_.size(); ++i) {
    const Edit& edit = *edits_[i];
    if (changes(edit)) {
      if (!edited) surface.find_edges(block, window_, parameters);
      edited = true;
      Edit own = edit;
      own.op = op_of(edit);
      if (own.op == EditOp::replace)
        surface.add_common(any, own, solids_->of(i), frame, window_);
      else
        surface.apply(own, solids_->of(i), frame, window_);
    }
    // Replacing one label by another leaves the union of all as it is.
    if (i + 1 < last_replace_ && edit.op != EditOp::replace)
      any.apply(edit, solids_->of(i), frame, window_);
  }
  return edited;
}

}  // namespace voxweld
