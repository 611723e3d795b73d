// What tests of labels.mode = "shared" begin with.
#pragma once

#include <gtest/gtest.h>

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
  return MemoryVolume::made<std::uint16_t>(splat(side), SampleType::u16, [](Index3) { return 0; });
}

inline void expect_same_tiles(const std::vector<TileMesh>& found,
                              const std::vector<TileMesh>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t t = 0; t < found.size(); ++t) {
    EXPECT_EQ(found[t].positions, expected[t].positions);
    EXPECT_EQ(found[t].triangles, expected[t].triangles);
    EXPECT_EQ(found[t].pairs, expected[t].pairs);
    EXPECT_EQ(found[t].triangle_pairs, expected[t].triangle_pairs);
  }
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
