// What repair remembers of triangles that intersect, against a look at all of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "stages/refine/edit_moves.h"
#include "stages/refine/known_hits.h"
#include "torus.h"

namespace voxweld {
namespace {

class KnownHitsTest : public ::testing::Test {
 protected:
  std::uint32_t random(std::uint32_t below) {
    return static_cast<std::uint32_t>(engine_() % below);
  }
  LatticePoint near(LatticePoint at, std::int32_t reach) {
    for (std::int32_t& x : at) {
      x += static_cast<std::int32_t>(random(2 * static_cast<std::uint32_t>(reach) + 1)) - reach;
      x = std::clamp(x, 0, 1000);
    }
    return at;
  }
  // A random change that is sound, whatever it makes intersect.
  bool propose() {
    const std::uint32_t t = random(mesh_.triangles());
    if (!mesh_.alive(t)) return false;
    const std::uint32_t u = mesh_.corners(t)[0], v = mesh_.corners(t)[1];
    const std::uint32_t kind = random(8);
    if (kind < 4) {
      step_ = {u, near(mesh_.position(u), 60), EditMesh::none};
      return mesh_.freedom(u) == Freedom::free && moves_.move(u, step_.to, change_);
    }
    if (kind < 7) {
      step_ = {};
      return mesh_.movable(t) && moves_.flip(t, kind - 4, change_);
    }
    const auto ends = moves_.ends(u, v);
    if (!ends || !moves_.linked(ends->gone, ends->keep)) return false;
    step_ = {ends->keep, mesh_.position(ends->keep), ends->gone};
    return moves_.collapse(ends->gone, ends->keep, step_.to, change_);
  }
  // By the exact test.
  std::vector<std::uint32_t> hit_by(std::uint32_t t) const {
    std::vector<std::uint32_t> found;
    for (std::uint32_t other = 0; other < mesh_.triangles(); ++other)
      if (other != t && mesh_.alive(other) &&
          intersect_beyond_shared(mesh_.shape(t), mesh_.shape(other)))
        found.push_back(other);
    return found;
  }
  bool is_old(std::uint32_t t) const { return std::ranges::count(change_.old, t) > 0; }
  std::size_t hits_of_change() const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < change_.shapes.size(); ++i) {
      const LatticeTriangle& own = change_.shapes[i];
      for (std::size_t j = 0; j < i; ++j)
        count += intersect_beyond_shared(own, change_.shapes[j]) ? 1 : 0;
      for (std::uint32_t t = 0; t < mesh_.triangles(); ++t)
        if (mesh_.alive(t) && !is_old(t))
          count += intersect_beyond_shared(own, mesh_.shape(t)) ? 1 : 0;
    }
    return count;
  }

  std::mt19937 engine_{3};
  EditMesh mesh_{testing::torus(), {{0, 0, 0}, {1000, 1000, 1000}}};
  EditMoves moves_{mesh_};
  KnownHits hits_{mesh_};
  Change change_;
  EditMesh::Step step_;
};

TEST_F(KnownHitsTest, StayTrueWhileTheMeshChanges) {
  std::size_t made = 0, some = 0;
  for (int round = 0; round < 3000; ++round) {
    if (propose() && mesh_.keeps_samples(change_, step_, 1e9)) {
      hits_.before(change_);
      mesh_.apply(change_, step_);
      hits_.after(change_);
      ++made;
    }
    // Few are asked for: others are not known when something changes near them.
    const std::uint32_t t = random(mesh_.triangles());
    if (!mesh_.alive(t)) continue;
    std::vector<std::uint32_t> known;
    hits_.each(t, [&](std::uint32_t other) { known.push_back(other); });
    std::ranges::sort(known);
    ASSERT_EQ(known, hit_by(t)) << round;
    ASSERT_EQ(hits_.any(t), !known.empty());
    some += known.empty() ? 0 : 1;
  }
  EXPECT_GT(made, 500u);
  EXPECT_GT(some, 300u);
}

TEST_F(KnownHitsTest, PairsOfSomeAreCountedOnce) {
  std::size_t most = 0;
  for (int round = 0; round < 1500; ++round) {
    if (!propose()) continue;
    std::size_t pairs = 0;
    std::vector<std::uint32_t> beside, others;
    for (const std::uint32_t t : change_.old)
      for (const std::uint32_t other : hit_by(t)) {
        pairs += !is_old(other) || other > t ? 1 : 0;
        if (!is_old(other)) beside.push_back(other);
      }
    std::ranges::sort(beside);
    beside.erase(std::unique(beside.begin(), beside.end()), beside.end());
    ASSERT_EQ(hits_.pairs_of(change_.old, others), pairs) << round;
    ASSERT_EQ(others, beside) << round;
    most = std::max(most, pairs);
    if (!mesh_.keeps_samples(change_, step_, 1e9)) continue;
    hits_.before(change_);
    mesh_.apply(change_, step_);
    hits_.after(change_);
  }
  EXPECT_GT(most, 4u);
}

// Whatever is looked at first; and no more is counted than was asked for.
TEST_F(KnownHitsTest, AChangeHitsWhatALookAtAllFinds) {
  std::size_t some = 0;
  std::vector<std::uint32_t> likely;
  for (int round = 0; round < 1500; ++round) {
    if (!propose()) continue;
    const std::size_t plain = hits_of_change();
    likely.clear();
    for (std::uint32_t t = 0; t < mesh_.triangles(); ++t)
      if (mesh_.alive(t) && !is_old(t) && random(3) == 0) likely.push_back(t);
    ASSERT_EQ(mesh_.hits(change_, 1000), plain) << round;
    ASSERT_EQ(mesh_.hits(change_, 1000, likely), plain) << round;
    if (plain > 1) {
      EXPECT_GE(mesh_.hits(change_, plain - 1, likely), plain - 1);
    }
    some += plain > 0 ? 1 : 0;
    if (mesh_.keeps_samples(change_, step_, 1e9)) mesh_.apply(change_, step_);
  }
  EXPECT_GT(some, 300u);
}

TEST_F(KnownHitsTest, HowFarSamplesComeIsWhatIsKept) {
  std::size_t between = 0;
  for (int round = 0; round < 2000; ++round) {
    if (!propose()) continue;
    const double enough = random(30), most = enough + random(30);
    const double reach = mesh_.squared_reach(change_, step_, enough, most);
    ASSERT_EQ(reach <= enough * enough, mesh_.keeps_samples(change_, step_, enough)) << round;
    ASSERT_EQ(reach <= most * most, mesh_.keeps_samples(change_, step_, most)) << round;
    between += reach > enough * enough && reach <= most * most ? 1 : 0;
    if (mesh_.keeps_samples(change_, step_, 40)) mesh_.apply(change_, step_);
  }
  EXPECT_GT(between, 50u);
}

// A neighbour may list one triangle of a pair and not know that the other one can change.
TEST_F(KnownHitsTest, OfAPairBothAreListedInTheEnd) {
  for (int round = 0; round < 400; ++round)
    if (propose() && mesh_.keeps_samples(change_, step_, 1e9)) mesh_.apply(change_, step_);
  const std::vector<std::uint32_t> all = mesh_.find_intersecting();
  ASSERT_GT(all.size(), 20u);
  std::vector<std::uint32_t> some;  // of each pair one at least
  for (const std::uint32_t t : all)
    if (std::ranges::any_of(hit_by(t), [&](std::uint32_t other) { return other > t; }))
      some.push_back(t);
  ASSERT_LT(some.size(), all.size());
  some.push_back(mesh_.triangles() - 1);  // and one that intersects nothing, if it is there
  mesh_.set_intersecting(some);
  mesh_.complete_intersecting();
  EXPECT_EQ(mesh_.intersecting(), all);
}

}  // namespace
}  // namespace voxweld
