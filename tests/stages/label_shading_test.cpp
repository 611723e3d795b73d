// Normals between labels: each triangle's corners have those of its own side of its own surface.
#include <gtest/gtest.h>

#include <cmath>

#include "stages/stitch/quad_split.h"
#include "tests/support/label_cases.h"

namespace voxweld {
namespace {

// A plate, and a block sunk into its upper face: around the block's foot three labels meet, and the
// plate's face ends there.
VolumeContour plate_and_block(Material plate, Material block, double tolerance) {
  const auto box = [](Material material, Vec3 center, Vec3 size) {
    return testing::box_edit(EditOp::add, material, center, size);
  };
  ContourParameters p = testing::shared_labels(tolerance);
  p.edits = {box(plate, {23.3, 23.4, 14.2}, {34.2, 33.6, 12.4}),
             box(block, {22.7, 24.1, 24.1}, {14.6, 15.2, 7.4})};  // it ends where the plate does
  return contour_volume(testing::no_labels(48), p, {5, 500000, 0.001});
}

struct Shading {
  std::size_t corners = 0;
  std::size_t off = 0;     // more than a degree from their triangle's normal
  std::size_t facing = 0;  // away from their triangle's side
};
Shading shading(const VolumeContour& contour) {
  Shading result;
  for (const TileMesh& tile : contour.tiles)
    for (std::size_t i = 0; i < tile.triangles.size(); ++i) {
      const auto [a, b, c] = tile.triangles[i];
      const Vec3 area = area_vector(tile.positions[a], tile.positions[b], tile.positions[c]);
      const double length = std::sqrt(dot(area, area));
      for (std::size_t k = 0; k < 3 && length > 0; ++k) {
        const Vec3 n = tile.corner_normals[i][k].of(tile.normals[tile.triangles[i][k]]);
        const double cosine = dot(n, area) / length;
        ++result.corners;
        result.off += cosine < std::cos(3.14159 / 180) ? 1 : 0;
        result.facing += cosine < 0 ? 1 : 0;
      }
    }
  return result;
}

TEST(LabelShading, IsSharpWhereThreeLabelsMeet) {
  for (const bool smaller_block : {false, true})
    for (const double tolerance : {0.0, 0.05}) {
      const VolumeContour contour =
          plate_and_block(smaller_block ? 9 : 4, smaller_block ? 4 : 9, tolerance);
      const Shading seen = shading(contour);
      EXPECT_GT(seen.corners, tolerance > 0 ? 100u : 10000u);
      EXPECT_EQ(seen.off, 0u) << smaller_block << ' ' << tolerance << " of " << seen.corners;
      EXPECT_EQ(seen.facing, 0u);
    }
}

}  // namespace
}  // namespace voxweld
