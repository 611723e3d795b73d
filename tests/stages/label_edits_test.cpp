// Edits between labels: cut edges are exact, and what no edit reaches stays as it was.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "tests/support/label_cases.h"
#include "tests/support/mesh_check.h"

namespace voxweld {
namespace {

using testing::box_edit;
using testing::MemoryVolume;
using testing::no_labels;

// Two labels side by side in a block, 0 around it.
MemoryVolume halves(std::int64_t side) {
  return MemoryVolume::made<std::uint16_t>(splat(side), SampleType::u16, [&](Index3 s) {
    const bool in = std::min({s.x, s.y, s.z}) >= 6 && std::max({s.x, s.y, s.z}) < side - 6;
    return !in ? 0 : 2 * s.x < side ? 1 : 2;
  });
}

ContourParameters with_edits(const Edits& edits, double tolerance = 0.05) {
  ContourParameters p = testing::shared_labels(tolerance);
  p.edits = edits;
  return p;
}

Edit ball(EditOp op, Material material, Vec3 center, double radius) {
  Edit edit;
  edit.op = op;
  edit.material = material;
  edit.solid.center = center;
  edit.solid.radius = radius;
  return edit;
}

// Enclosed volume of each label, and how many edges of it do not balance.
struct Volumes {
  std::map<Material, double> of;
  std::size_t unbalanced = 0;
};
Volumes volumes(const MemoryVolume& volume, const ContourParameters& parameters, int level = 5) {
  const auto contour = contour_volume(volume, parameters, {level, 500000, 0.001});
  Volumes result;
  std::map<std::tuple<std::uint32_t, std::uint32_t, Material>, int> balance;
  const auto mesh = testing::weld_tiles(contour.tiles);
  std::size_t i = 0;
  for (const TileMesh& tile : contour.tiles)
    for (const std::uint32_t number : tile.triangle_pairs) {
      const MaterialPair pair = tile.pairs[number];
      Vec3 p[3];
      for (std::size_t k = 0; k < 3; ++k) {
        p[k] = testing::place_of(tile.lattice, mesh.vertices[mesh.triangles[i][k]]);
        const std::uint32_t from = mesh.triangles[i][k], to = mesh.triangles[i][(k + 1) % 3];
        const int way = from < to ? 1 : -1;
        balance[{std::min(from, to), std::max(from, to), pair.inside}] += way;
        balance[{std::min(from, to), std::max(from, to), pair.outside}] -= way;
      }
      const double six = dot(p[0], cross(p[1], p[2]));
      result.of[pair.inside] += six / 6;
      result.of[pair.outside] -= six / 6;
      ++i;
    }
  for (const auto& [edge, sum] : balance) result.unbalanced += sum != 0 ? 1 : 0;
  return result;
}

TEST(LabelEdits, SolidModellingWithMaterialsHasExactVolumes) {
  // A box of 1, a box of 2 over one of its corners, a hole through both.
  const Edits edits = {box_edit(EditOp::add, 1, {24.3, 25.1, 24.7}, {22, 20, 18}),
                       box_edit(EditOp::add, 2, {35.3, 35.1, 33.7}, {10, 12, 14}),
                       box_edit(EditOp::subtract, exterior, {24.3, 25.1, 24.7}, {4, 5, 100})};
  for (const double tolerance : {0.001, 0.05}) {
    const Volumes v = volumes(no_labels(60), with_edits(edits, tolerance));
    EXPECT_EQ(v.unbalanced, 0u);
    // 2 took a corner of 5 x 6 x 7 from 1, the hole 4 x 5 x 18 of it and nothing of 2.
    EXPECT_NEAR(v.of.at(2), 10 * 12 * 14, 2) << tolerance;
    EXPECT_NEAR(v.of.at(1), 22 * 20 * 18 - 5 * 6 * 7 - 4 * 5 * 18, 4) << tolerance;
  }
}

TEST(LabelEdits, ReplaceTakesOnlyWhatIsThere) {
  const MemoryVolume volume = halves(48);
  const Volumes before = volumes(volume, with_edits({}));
  // Half out of the block, half in label 1 and 2.
  const Volumes v = volumes(volume, with_edits({ball(EditOp::replace, 9, {24, 24, 41.5}, 12)}));
  EXPECT_EQ(v.unbalanced, 0u);
  const double half = 2.0 / 3 * 3.14159265 * 12 * 12 * 12;
  EXPECT_NEAR(v.of.at(9), half, 0.02 * half);
  EXPECT_NEAR(v.of.at(1) + v.of.at(2) + v.of.at(9), before.of.at(1) + before.of.at(2), 30);
  // add takes all of it.
  const Volumes all = volumes(volume, with_edits({ball(EditOp::add, 9, {24, 24, 41.5}, 12)}));
  EXPECT_EQ(all.unbalanced, 0u);
  const double beyond = 3.14159265 * 6 * 6 * (3 * 12 - 6) / 3;  // the volume ends at 47.5
  EXPECT_NEAR(all.of.at(9), 2 * half - beyond, 0.01 * half);
}

TEST(LabelEdits, IntersectKeepsTheLabelsInTheSolid) {
  const Volumes v = volumes(
      halves(48), with_edits({box_edit(EditOp::intersect, exterior, {24, 24, 24}, {20, 16, 12})}));
  EXPECT_EQ(v.unbalanced, 0u);
  ASSERT_EQ(v.of.size(), 3u);
  EXPECT_NEAR(v.of.at(1) + v.of.at(2), 20 * 16 * 12, 8);
  EXPECT_NEAR(v.of.at(1), (23.5 - 14) * 16 * 12, 20);
}

TEST(LabelEdits, AUnionOfOneLabelHasNoWallInIt) {
  const Edits edits = {ball(EditOp::add, 5, {22, 24, 24}, 10),
                       ball(EditOp::add, 5, {30, 24, 24}, 10)};
  const Volumes v = volumes(no_labels(52), with_edits(edits));
  EXPECT_EQ(v.unbalanced, 0u);
  EXPECT_EQ(v.of.size(), 2u);                            // and the outside
  const double cap = 3.14159265 * 6 * 6 * (30 - 6) / 3;  // of height 10 - 4, twice in the overlap
  EXPECT_NEAR(v.of.at(5), 2 * 4.0 / 3 * 3.14159265 * 1000 - 2 * cap, 25);
}

TEST(LabelEdits, DoNotDependOnTheBricks) {
  const Edits edits = {ball(EditOp::add, 7, {20.2, 24.1, 30.3}, 11.3),
                       box_edit(EditOp::replace, 1, {30, 20, 22}, {13, 17, 20}),
                       ball(EditOp::subtract, exterior, {31.5, 33.3, 18.2}, 8)};
  const auto p = with_edits(edits);
  const MemoryVolume volume = halves(50);
  const auto first = contour_volume(volume, p, {4, 1024, 0.01});
  for (const int level : {5, 6})
    testing::expect_same_tiles(contour_volume(volume, p, {level, 1024, 0.01}).tiles, first.tiles);
}

// One material, added and taken away: what the edits of signs give, to the bit.
TEST(LabelEdits, OfOneMaterialAreTheEditsOfSigns) {
  Edits edits = {ball(EditOp::add, 1, {22, 24, 24}, 10),
                 box_edit(EditOp::add, 1, {30.2, 24.4, 23.1}, {12, 13, 14}),
                 ball(EditOp::subtract, exterior, {24, 20, 28}, 7),
                 box_edit(EditOp::intersect, exterior, {25, 25, 25}, {25, 22, 21})};
  const auto labels = contour_volume(no_labels(52), with_edits(edits), {5, 2048, 0.01});
  ContourParameters signs = with_edits(edits);
  signs.labels = {};
  signs.surface.isovalue = 1;
  for (Edit& edit : signs.edits) edit.material = exterior;
  const auto scalar = contour_volume(no_labels(52), signs, {5, 2048, 0.01});
  ASSERT_EQ(labels.tiles.size(), scalar.tiles.size());
  for (std::size_t t = 0; t < labels.tiles.size(); ++t) {
    EXPECT_EQ(labels.tiles[t].positions, scalar.tiles[t].positions);
    EXPECT_EQ(labels.tiles[t].triangles, scalar.tiles[t].triangles);
  }
}

}  // namespace
}  // namespace voxweld
