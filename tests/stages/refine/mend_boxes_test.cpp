// The boxes of mend: apart from each other, with room around each place, and whatever order the places
// come in.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <random>

#include "stages/refine/mend_boxes.h"
#include "stages/stitch/lattice_plan.h"

namespace voxweld {
namespace {

RefineFrame frame_of(std::int64_t side) {
  return {plan_lattice({splat(side), {1, 1, 1}, 0.01}), {1, 1, 1}, {}, splat(side)};
}

std::int32_t cells(const RefineFrame& frame, double count) {
  return static_cast<std::int32_t>(count / frame.lattice.step);
}

std::vector<IntersectionPlace> random_places(const RefineFrame& frame, std::size_t count,
                                             double length, std::uint64_t around, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<std::int32_t> at(0, cells(frame, 480)),
      side(1, cells(frame, length));
  std::vector<IntersectionPlace> places(count);
  for (IntersectionPlace& place : places) {
    place.around = around;
    for (std::size_t a = 0; a < 3; ++a) {
      place.box.lo[a] = at(random);
      place.box.hi[a] = place.box.lo[a] + side(random);
    }
  }
  return places;
}

bool holds(const LatticeBox& box, const LatticeBox& inner) {
  return box.contains(inner.lo) && box.contains(inner.hi);
}

void expect_apart(const std::vector<LatticeBox>& boxes) {
  for (std::size_t i = 0; i < boxes.size(); ++i)
    for (std::size_t j = i + 1; j < boxes.size(); ++j) EXPECT_FALSE(boxes[i].meets(boxes[j]));
}

TEST(MendBoxes, NoneForNothing) {
  EXPECT_TRUE(mend_boxes({}, frame_of(512)).empty());
}

TEST(MendBoxes, APlaceHasRoomEvenAtBordersOfCubes) {
  const RefineFrame frame = frame_of(512);
  const std::int32_t border = CubeLattice(frame, 0).box({1, 1, 1}).lo[0];
  const LatticeBox place{{border - 5, border - 5, border - 5},
                         {border + 5, border + 5, border + 5}};
  const auto boxes = mend_boxes({{place, 1000}}, frame);
  ASSERT_EQ(boxes.size(), 1u);
  const std::int32_t room = cells(frame, 12);
  for (std::size_t a = 0; a < 3; ++a) {
    EXPECT_LE(boxes[0].lo[a], place.lo[a] - room);
    EXPECT_GE(boxes[0].hi[a], place.hi[a] + room);
    EXPECT_LE(boxes[0].hi[a] - boxes[0].lo[a], 3 * (room + 20));
  }
}

// Vertices may be moved anywhere in a box, and far beyond the volume there is nothing to write them by.
TEST(MendBoxes, AndCubesStayInTheVolume) {
  for (const std::int64_t side : {44, 127, 128, 500}) {
    SCOPED_TRACE(side);
    const RefineFrame frame = frame_of(side);
    const std::int32_t end = cells(frame, static_cast<double>(side) + 1);
    const std::int32_t last = end + most_snap_steps;
    const LatticeBox volume{{0, 0, 0}, {last, last, last}};
    for (int pass = 0; pass < refine_passes; ++pass) {
      const CubeLattice cubes(frame, pass);
      EXPECT_EQ(cubes.bounds(), volume);
      for (const LatticePoint& corner : {volume.lo, volume.hi}) {
        const LatticeBox box = cubes.box(cubes.cube_of(corner));
        EXPECT_TRUE(holds(volume, box) && box.contains(corner));
      }
    }
    const LatticeBox low{{3, 3, 3}, {9, 9, 9}}, high{{end - 9, 3, 3}, {end - 3, 9, 9}};
    for (const std::uint64_t around : {100u, 500000u})
      for (const LatticeBox& box : mend_boxes({{low, around}, {high, around}}, frame))
        EXPECT_TRUE(holds(volume, box));
  }
}

// Some near each other, some alone; long ones too.
TEST(MendBoxes, AreApartAndHoldAllPlaces) {
  const RefineFrame frame = frame_of(512);
  const std::int32_t room = cells(frame, 12);
  const LatticeBox bounds = CubeLattice(frame, 0).bounds();
  for (unsigned seed = 0; seed < 6; ++seed) {
    SCOPED_TRACE(seed);
    const bool long_ones = seed % 2 != 0;
    auto places =
        random_places(frame, long_ones ? 3 + seed : 20 + 10 * seed, long_ones ? 40 : 3, 10, seed);
    const auto boxes = mend_boxes(places, frame);
    EXPECT_GT(boxes.size(), 1u);
    EXPECT_LE(boxes.size(), places.size());
    expect_apart(boxes);
    for (const IntersectionPlace& place : places) {
      LatticeBox with_room = place.box;
      for (std::size_t a = 0; a < 3; ++a) {
        with_room.lo[a] = std::max(bounds.lo[a], with_room.lo[a] - room);
        with_room.hi[a] = std::min(bounds.hi[a], with_room.hi[a] + room);
      }
      EXPECT_EQ(std::ranges::count_if(boxes, [&](const auto& b) { return holds(b, with_room); }),
                1);
    }
    std::ranges::shuffle(places, std::mt19937(seed));
    EXPECT_EQ(mend_boxes(places, frame), boxes);
  }
}

// Dense meshes: with all the room they would run together, and would have to be cut.
TEST(MendBoxes, HaveLessRoomWhereTheyWouldHoldTooMuch) {
  const RefineFrame frame = frame_of(40);
  std::vector<IntersectionPlace> places;
  each_index({{}, splat(3)}, [&](Index3 at) {
    LatticePoint lo{};
    for (int a = 0; a < 3; ++a)
      lo[static_cast<std::size_t>(a)] = cells(frame, 4 + 14 * static_cast<double>(at[a]));
    places.push_back({{lo, lo}, 170000});
  });
  const auto boxes = mend_boxes(places, frame);
  EXPECT_EQ(boxes.size(), 27u);
  expect_apart(boxes);
  const std::int32_t room = cells(frame, 1.5);
  for (const IntersectionPlace& place : places) {
    LatticeBox with_room = place.box;
    for (std::size_t a = 0; a < 3; ++a) {
      with_room.lo[a] -= room;
      with_room.hi[a] += room;
    }
    EXPECT_EQ(std::ranges::count_if(boxes, [&](const auto& b) { return holds(b, with_room); }), 1);
  }
  std::ranges::reverse(places);
  EXPECT_EQ(mend_boxes(places, frame), boxes);
  // Few triangles: one box for all.
  for (IntersectionPlace& place : places) place.around = 100;
  EXPECT_EQ(mend_boxes(places, frame).size(), 1u);
}

// Everywhere, in a mesh of so many triangles that they cannot be done at once.
TEST(MendBoxes, WhereManyRunTogetherTheyAreCut) {
  const RefineFrame frame = frame_of(512);
  const auto places = random_places(frame, 20000, 2, 500000, 1);
  const auto boxes = mend_boxes(places, frame);
  EXPECT_GT(boxes.size(), 400u);
  expect_apart(boxes);
  const std::int32_t side = cells(frame, 32) + 1;
  for (const LatticeBox& box : boxes)
    for (std::size_t a = 0; a < 3; ++a) EXPECT_LE(box.hi[a] - box.lo[a], side);
  // All are met, and most lie within one.
  std::ptrdiff_t within = 0;
  for (const IntersectionPlace& place : places) {
    EXPECT_TRUE(std::ranges::any_of(boxes, [&](const auto& b) { return b.meets(place.box); }));
    within += std::ranges::count_if(boxes, [&](const auto& b) { return holds(b, place.box); });
  }
  EXPECT_GT(within, 16000);
  EXPECT_LT(within, 20000);
}

// What cannot be planned as a whole.
TEST(MendBoxes, WithinCubesNeedOnlyTheirOwnPlaces) {
  const RefineFrame frame = frame_of(512);
  const CubeLattice cubes(frame, 0);
  const MendRoom room{.pass = 0, .cells = 1.5, .lengths = 0};
  const auto places = random_places(frame, 600, 9, 10, 4);
  const auto all = mend_boxes_within(places, frame, room, cubes);
  expect_apart(all);
  std::size_t inside = 0;
  std::map<std::uint64_t, std::vector<IntersectionPlace>> of_cube;
  for (const IntersectionPlace& place : places) {
    const Index3 cube = cubes.cube_of(place.box.lo);
    const bool lies_within = cube == cubes.cube_of(place.box.hi);
    EXPECT_EQ(std::ranges::count_if(all, [&](const auto& b) { return holds(b, place.box); }),
              lies_within ? 1 : 0);
    inside += lies_within ? 1 : 0;
    of_cube[morton_encode(cube)].push_back(place);
  }
  EXPECT_GT(inside, 400u);
  EXPECT_LT(inside, places.size());
  // Cube by cube they are the same.
  std::vector<LatticeBox> each;
  for (const auto& [cube, some] : of_cube)
    for (const LatticeBox& box : mend_boxes_within(some, frame, room, cubes)) {
      EXPECT_TRUE(holds(cubes.box(morton_decode(cube)), box));
      each.push_back(box);
    }
  std::ranges::sort(each, {}, &LatticeBox::lo);
  EXPECT_EQ(each, all);
}

// What one of them cannot change at a border the other one can.
TEST(MendBoxes, CutsOfTwoKindsLieApart) {
  const RefineFrame frame = frame_of(512);
  std::vector<IntersectionPlace> places;
  for (std::int32_t x = 0; x < cells(frame, 500); x += cells(frame, 1))
    places.push_back({{{x, 700, 700}, {x + 9, 709, 709}}, 20'000'000});
  const auto borders = [&](int cut) {
    const MendRoom room{.cut = cut, .cells = 1.5, .lengths = 0};
    const auto boxes = mend_boxes(places, frame, room);
    expect_apart(boxes);
    std::vector<std::int32_t> ends;
    ends.reserve(boxes.size());
    for (const LatticeBox& box : boxes) ends.push_back(box.hi[0]);
    return ends;
  };
  const auto first = borders(0), second = borders(1);
  EXPECT_GT(first.size(), 10u);
  for (std::size_t i = 0; i + 1 < first.size(); ++i)
    for (std::size_t j = 0; j + 1 < second.size(); ++j)
      EXPECT_GT(std::abs(first[i] - second[j]), cells(frame, 8));
}

}  // namespace
}  // namespace voxweld
