// The tree of coarser tiles: which there are, and what they stand for.
#include "pipeline/stage/level_tree.h"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

namespace voxweld::testing {
namespace {

std::vector<LevelLeaf> tiles_in(std::initializer_list<CellKey> cells) {
  std::vector<LevelLeaf> leaves;
  for (const CellKey& cell : cells) leaves.push_back({cell, 1000});
  return leaves;
}
LevelTree tree_of(std::vector<LevelLeaf> leaves, std::int64_t levels, int least) {
  return LevelTree(std::move(leaves), {.levels = levels, .least = least});
}

TEST(LevelTree, OneNodeForEachCubeOfSeveral) {
  // Two tiles in one cube of level 8, one in another.
  const auto tiles = tiles_in({{7, {0, 0, 0}}, {7, {1, 0, 0}}, {8, {1, 1, 0}}});
  const LevelTree tree = tree_of(tiles, 0, 6);
  ASSERT_EQ(tree.nodes().size(), 2u);
  EXPECT_EQ(tree.nodes()[0].name(), "1/8-0-0-0");
  EXPECT_EQ(tree.nodes()[0].leaves, (std::vector<std::uint64_t>{0, 1}));
  EXPECT_FALSE(tree.nodes()[0].all);
  EXPECT_EQ(tree.nodes()[1].name(), "2/9-0-0-0");
  EXPECT_EQ(tree.nodes()[1].nodes, std::vector<std::uint64_t>{0});
  EXPECT_EQ(tree.nodes()[1].leaves, std::vector<std::uint64_t>{2});
  EXPECT_TRUE(tree.nodes()[1].all);
  EXPECT_EQ(tree.ends(), (std::vector<std::uint64_t>{1, 2}));
  std::vector<std::uint64_t> nodes, left;
  tree.cut(
      1, [&](auto n) { nodes.push_back(n); }, [&](auto t) { left.push_back(t); });
  EXPECT_EQ(nodes, std::vector<std::uint64_t>{0});
  EXPECT_EQ(left, std::vector<std::uint64_t>{2});
}

TEST(LevelTree, NoNodeIsSmallerThanACubeOfRefine) {
  const auto tiles = tiles_in({{4, {0, 0, 0}}, {4, {1, 0, 0}}, {5, {1, 1, 1}}});
  const LevelTree tree = tree_of(tiles, 0, 6);
  ASSERT_EQ(tree.nodes().size(), 1u);
  EXPECT_EQ(tree.nodes()[0].name(), "1/6-0-0-0");
  EXPECT_EQ(tree.nodes()[0].leaves.size(), 3u);
}

TEST(LevelTree, HasAsManyLevelsAsAreAskedFor) {
  const auto tiles = tiles_in({{6, {0, 0, 0}}, {6, {1, 0, 0}}, {7, {1, 1, 0}}, {8, {1, 0, 0}}});
  EXPECT_EQ(tree_of(tiles, 0, 6).top(), 3);
  EXPECT_EQ(tree_of(tiles, 1, 6).top(), 0);
  const LevelTree two = tree_of(tiles, 2, 6);
  EXPECT_EQ(two.top(), 1);
  EXPECT_EQ(two.root_leaves(), (std::vector<std::uint64_t>{2, 3}));
  EXPECT_EQ(two.root_nodes(), std::vector<std::uint64_t>{0});
  const LevelTree many = tree_of(tiles, 6, 6);
  EXPECT_EQ(many.top(), 5);
  EXPECT_EQ(many.nodes().back().cell, many.nodes()[2].cell);
  EXPECT_TRUE(many.nodes().back().all && many.nodes()[2].all);
  EXPECT_FALSE(many.nodes()[1].all);
  EXPECT_EQ(tree_of(tiles_in({{5, {3, 0, 0}}}), 0, 6).top(), 0);
  EXPECT_EQ(tree_of(tiles_in({{5, {3, 0, 0}}}), 2, 6).nodes()[0].name(), "1/6-1-0-0");
  EXPECT_EQ(tree_of({}, 4, 6).top(), 0);
}

// What node each cube gets whose eight octants have a tile of so many vertices each.
std::vector<LevelNode> full_nodes(std::uint64_t vertices, std::uint64_t most,
                                  double tolerance = 0.01) {
  std::vector<LevelLeaf> leaves;
  for (std::uint64_t code = 0; code < 64; ++code)
    leaves.push_back({{7, morton_decode(code)}, vertices});
  return LevelTree(std::move(leaves), {.least = 6, .most_vertices = most, .tolerance = tolerance})
      .nodes();
}

TEST(LevelTree, ToleranceGrowsFasterWhereTheVolumeIsFullOfSurface) {
  // Of eight thousand vertices a quarter is left, two thousand, and of eight times these four thousand.
  const std::vector<LevelNode> any = full_nodes(1000, 0), many = full_nodes(1000, 4000);
  ASSERT_EQ(any.size(), 9u);
  EXPECT_EQ(any[0].doublings, 2);
  EXPECT_EQ(any[8].doublings, 4);
  EXPECT_EQ(any, many);
  EXPECT_EQ(full_nodes(1000, 3999)[0].doublings, 2);
  EXPECT_EQ(full_nodes(1000, 3999)[8].doublings, 5);
  // A thousand is left at level 1 with eight times the tolerance, and two thousand or one above it.
  const std::vector<LevelNode> few = full_nodes(1000, 1000);
  EXPECT_EQ(few[0].doublings, 3);
  EXPECT_EQ(few[8].doublings, 6);
  // By one doubling a level at most.
  EXPECT_EQ(full_nodes(1000, 10)[0].doublings, 3);
  // Cells have 256 and 512 finest cells a side, of which a 64th part is 4 and 8.
  EXPECT_EQ(full_nodes(1000, 1000, 0.5)[0].doublings, 3);
  EXPECT_EQ(full_nodes(1000, 1000, 0.5)[8].doublings, 5);
  EXPECT_EQ(full_nodes(1000, 1000, 0.51)[0].doublings, 2);
}

// A label in one tile, around this cell of level 4.
LevelLeaf small_label(Material label, Index3 at, std::uint64_t vertices = 100) {
  return {{4, at}, vertices, label, true};
}
LevelTree label_tree(std::vector<LevelLeaf> leaves, std::int64_t levels = 0) {
  return LevelTree(std::move(leaves),
                   {.levels = levels, .least = 6, .few_vertices = 1000, .of_labels = true});
}

TEST(LabelLevelTree, FewVerticesNeedNoNode) {
  const std::vector<LevelLeaf> few = {small_label(1, {0, 0, 0}), small_label(2, {9, 9, 9}, 900)};
  EXPECT_EQ(label_tree(few).top(), 0);
  EXPECT_EQ(label_tree(few).root_leaves(), (std::vector<std::uint64_t>{0, 1}));
  // One node where one is asked for.
  const LevelTree one = label_tree(few, 2);
  ASSERT_EQ(one.nodes().size(), 1u);
  EXPECT_EQ(one.nodes()[0].leaves, (std::vector<std::uint64_t>{0, 1}));
  EXPECT_TRUE(one.nodes()[0].all);
  const LevelTree many = label_tree({small_label(1, {0, 0, 0}), small_label(2, {9, 9, 9}, 901)});
  ASSERT_EQ(many.nodes().size(), 1u);
  EXPECT_EQ(many.nodes()[0].height, 1);
}

// Label 7 has two tiles of level 8, and others lie in the same cubes.
TEST(LabelLevelTree, HoldsLabelsWhereTheyLie) {
  const LevelTree tree = label_tree({small_label(3, {1, 1, 1}, 600),
                                     small_label(5, {2, 9, 9}, 600),
                                     {{8, {0, 0, 0}}, 800, 7, false},
                                     {{8, {1, 0, 0}}, 800, 7, false},
                                     small_label(9, {17, 1, 1}, 100)});
  ASSERT_EQ(tree.nodes().size(), 2u);
  // That of level 8 has the tile that fills it and the two small ones, which are many together.
  const LevelNode& low = tree.nodes()[0];
  EXPECT_EQ(low.name(), "1/8-0-0-0");
  EXPECT_EQ(low.leaves, (std::vector<std::uint64_t>{2, 0, 1}));
  EXPECT_EQ(tree.nodes()[1].name(), "2/9-0-0-0");
  EXPECT_EQ(tree.nodes()[1].leaves, (std::vector<std::uint64_t>{3, 4}));
  const auto in_low = tree.surfaces(0), in_all = tree.surfaces(1);
  ASSERT_EQ(in_low.size(), 3u);
  EXPECT_EQ(in_low[0].label, 3u);
  EXPECT_TRUE(in_low[0].all && in_low[1].all);
  EXPECT_EQ(in_low[2].label, 7u);
  EXPECT_FALSE(in_low[2].all);
  EXPECT_EQ(in_low[2].leaves, std::vector<std::uint64_t>{2});
  ASSERT_EQ(in_all.size(), 4u);
  EXPECT_TRUE(in_all[2].all);
  EXPECT_EQ(in_all[2].leaves, std::vector<std::uint64_t>{3});
  EXPECT_TRUE(in_all[0].leaves.empty());
}

// Whatever the leaves, each level shows all of them once, and where they lie says where to look.
TEST(LabelLevelTree, EachLevelShowsAllOnce) {
  std::mt19937 random(3);
  for (int round = 0; round < 200; ++round) {
    std::vector<LevelLeaf> leaves;
    const Material labels = 1 + random() % 60;
    for (Material label = 0; label < labels; ++label) {
      const auto at = [&] { return static_cast<std::int64_t>(random() % 40); };
      leaves.push_back(small_label(label, {at(), at(), at()}, random() % 700));
    }
    // One that fills all of its cubes.
    const std::int64_t side = 1 + static_cast<std::int64_t>(random() % 2);
    for (std::int64_t x = 0; x < side; ++x)
      leaves.push_back({{8, {x, 0, 0}}, 900, labels, side == 1});
    const LevelTree tree = label_tree(leaves, static_cast<std::int64_t>(random() % 4));
    std::vector<std::uint64_t> all(leaves.size());
    std::iota(all.begin(), all.end(), std::uint64_t{0});
    for (int height = 0; height <= tree.top(); ++height) {
      std::vector<std::uint64_t> shown;
      tree.cut(
          height,
          [&](std::uint64_t n) {
            const LevelNode& node = tree.nodes()[n];
            EXPECT_GE(node.cell.level, 6);
            for (const LevelSurface& surface : tree.surfaces(n))
              for (std::uint64_t leaf = 0; leaf < leaves.size(); ++leaf) {
                const CellKey& place = leaves[leaf].place;
                const bool inside =
                    leaves[leaf].label == surface.label && place.level <= node.cell.level &&
                    place.code() - node.cell.code() < std::uint64_t{1} << (3 * node.cell.level);
                if (inside) shown.push_back(leaf);
              }
          },
          [&](std::uint64_t leaf) { shown.push_back(leaf); });
      std::ranges::sort(shown);
      EXPECT_EQ(shown, all) << round << " at " << height;
    }
  }
}

}  // namespace
}  // namespace voxweld::testing
