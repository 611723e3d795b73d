// What tests of labels.mode = "shared" begin with.
#pragma once

#include <memory>

#include "tests/support/contour_in_memory.h"

namespace voxweld::testing {

// Label 0 is outside of all; not simplified at a tolerance of 0.
inline ContourParameters shared_labels(double tolerance) {
  ContourParameters p;
  p.labels.mode = LabelMode::shared;
  MaterialRules rules;
  rules.ranges.push_back({0, 0, false, exterior});
  p.labels.rules = std::make_shared<const MaterialRules>(rules);
  p.simplify.enabled = tolerance > 0;
  p.simplify.tolerance = tolerance;
  return p;
}

// Nothing but label 0.
inline MemoryVolume no_labels(std::int64_t side) {
  return MemoryVolume::of<std::uint16_t>(
      splat(side), std::vector<std::uint16_t>(static_cast<std::size_t>(side * side * side)),
      SampleType::u16);
}

inline Edit box_edit(EditOp op, Material material, Vec3 center, Vec3 size) {
  Edit edit;
  edit.op = op;
  edit.material = material;
  edit.solid.shape = SolidShape::box;
  edit.solid.center = center;
  edit.solid.size = size;
  return edit;
}

}  // namespace voxweld::testing
