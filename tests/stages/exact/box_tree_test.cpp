// What the tree finds against a look at all boxes.
#include "stages/exact/box_tree.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace voxweld {
namespace {

class Boxes {
 public:
  LatticeBox next(std::int32_t most_side) {
    LatticeBox box{};
    for (std::size_t a = 0; a < 3; ++a) {
      box.lo[a] = number(1000);
      box.hi[a] = box.lo[a] + number(most_side);
    }
    return box;
  }
  std::int32_t number(std::int32_t end) {
    return static_cast<std::int32_t>(engine_() % static_cast<std::uint32_t>(end));
  }

 private:
  std::mt19937 engine_{11};
};

// Of trees of one level to four.
TEST(BoxTree, AsksWhatMeetsOnceFromWhateverPlace) {
  Boxes random;
  for (const std::size_t count : {0, 1, 2, 8, 9, 70, 1000}) {
    std::vector<LatticeBox> boxes;
    for (std::size_t i = 0; i < count; ++i) boxes.push_back(random.next(60));
    const BoxTree tree(boxes);
    for (int i = 0; i < 100; ++i) {
      const LatticeBox box = random.next(200);
      std::multiset<std::uint32_t> meeting, asked, asked_near;
      for (std::uint32_t b = 0; b < count; ++b)
        if (boxes[b].meets(box)) meeting.insert(b);
      tree.each_meeting(box, [&](std::uint32_t b) { asked.insert(b); });
      EXPECT_EQ(asked, meeting);
      const auto start = static_cast<std::uint32_t>(random.number(1200));
      std::uint32_t place = start;
      EXPECT_FALSE(tree.any_meeting_near(box, place, [&](std::uint32_t b) {
        asked_near.insert(b);
        return false;
      }));
      EXPECT_EQ(asked_near, meeting);
      EXPECT_EQ(place, start);
    }
  }
}

TEST(BoxTree, AsksFirstWhatItFoundBefore) {
  Boxes random;
  std::vector<LatticeBox> boxes;
  boxes.reserve(500);
  for (int i = 0; i < 500; ++i) boxes.push_back(random.next(60));
  const BoxTree tree(boxes);
  std::uint32_t place = 0;
  for (std::uint32_t wanted = 0; wanted < boxes.size(); ++wanted) {
    EXPECT_TRUE(
        tree.any_meeting_near(boxes[wanted], place, [&](std::uint32_t b) { return b == wanted; }));
    std::vector<std::uint32_t> asked;
    EXPECT_TRUE(tree.any_meeting_near(boxes[wanted], place, [&](std::uint32_t b) {
      asked.push_back(b);
      return true;
    }));
    EXPECT_EQ(asked, std::vector{wanted});
  }
}

}  // namespace
}  // namespace voxweld
