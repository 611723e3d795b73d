// What mend holds of a part of a piece, against a plain look at all triangles.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include "pipeline/refine/box_reads.h"

namespace voxweld {
namespace {

using Places = std::array<LatticePoint, 3>;

// Triangles of some steps each, with corners of their own, strewn over a cube; one of seven has a sample,
// one of five intersects something.
RefineMesh strewn(std::uint32_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<std::int32_t> where(0, 4000), off(-6, 6);
  RefineMesh mesh;
  for (std::uint32_t t = 0; t < count; ++t) {
    const LatticePoint at{where(random), where(random), where(random)};
    for (std::uint32_t k = 0; k < 3; ++k) {
      mesh.positions.push_back({at[0] + off(random), at[1] + off(random), at[2] + off(random)});
      mesh.ids.push_back({(std::uint64_t{3} * t + k) << 2});
    }
    mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    if (t % 7 == 0) mesh.samples.push_back({{}, t});
    if (t % 5 == 0) mesh.intersecting.push_back(t);
  }
  return mesh;
}

Places places_of(const RefineMesh& mesh, std::uint32_t t) {
  const auto& [a, b, c] = mesh.triangles[t];
  return {mesh.positions[a], mesh.positions[b], mesh.positions[c]};
}

void expect_holds_what_meets(const RefineMesh& mesh, const std::vector<LatticeBox>& boxes,
                             bool copies) {
  const HeldPart held(mesh, BoxTree(boxes));
  std::size_t near = 0;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    near += std::ranges::any_of(boxes, [&](const auto& box) { return mesh.box(t).meets(box); });
  EXPECT_GT(near, boxes.size());
  EXPECT_EQ(held.mesh().triangles.size(), copies ? near : mesh.triangles.size());
  for (const LatticeBox& box : boxes) {
    std::vector<Places> expected, found;
    std::vector<bool> bad, found_bad;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
      if (mesh.box(t).meets(box)) {
        expected.push_back(places_of(mesh, t));
        bad.push_back(mesh.intersects(t));
      }
    for (const std::uint32_t t : held.meeting(box)) {
      found.push_back(places_of(held.mesh(), t));
      found_bad.push_back(held.mesh().intersects(t));
    }
    EXPECT_EQ(found, expected);
    EXPECT_EQ(found_bad, bad);
  }
  const auto sampled = std::ranges::count_if(mesh.samples, [&](const SurfaceSample& sample) {
    return !copies || std::ranges::any_of(boxes, [&](const auto& box) {
      return mesh.box(sample.triangle).meets(box);
    });
  });
  EXPECT_EQ(held.mesh().samples.size(), static_cast<std::size_t>(sampled));
}

TEST(HeldPart, HoldsOnlyWhatMeetsABox) {
  const RefineMesh mesh = strewn(20000, 1);
  expect_holds_what_meets(mesh,
                          {{{100, 100, 100}, {600, 700, 800}},
                           {{1500, 0, 0}, {1900, 900, 4000}},
                           {{3000, 3000, 3000}, {3400, 3400, 3500}}},
                          true);
}

TEST(HeldPart, KeepsAllWhereNearlyAllMeetOne) {
  expect_holds_what_meets(strewn(3000, 2), {{{-10, -10, -10}, {3900, 3900, 4010}}}, false);
}

TEST(HeldPart, OfNothingIsNothing) {
  const std::vector<LatticeBox> boxes{{{0, 0, 0}, {9, 9, 9}}};
  const HeldPart held(RefineMesh{}, BoxTree(boxes));
  EXPECT_TRUE(held.mesh().triangles.empty());
  EXPECT_TRUE(held.meeting(boxes[0]).empty());
}

}  // namespace
}  // namespace voxweld
