#include "stages/contouring/label_topology.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

namespace voxweld {
namespace {

CellLabels labels_of(unsigned signs) {
  CellLabels labels;
  for (std::size_t i = 0; i < 8; ++i) labels[i] = (signs >> i & 1u) != 0 ? 3 : 8;
  return labels;
}

TEST(LabelTopology, TwoLabelsAreSigns) {
  for (unsigned s = 0; s < 256; ++s) {
    const CellSheets one = label_sheets(labels_of(s));
    const CellSheets& other = cell_sheets(static_cast<CellSigns>(s), false);
    EXPECT_EQ(one.sheets, other.sheets) << s;
    EXPECT_EQ(one.crossings, other.crossings) << s;
    EXPECT_EQ(one.edges, other.edges) << s;
    EXPECT_EQ(one.sheet_of_edge, other.sheet_of_edge) << s;
    EXPECT_EQ(labels_collapsible(labels_of(s)), collapsible(static_cast<CellSigns>(s))) << s;
  }
}

TEST(LabelTopology, TwoLabelsOfANodeAreItsSigns) {
  std::mt19937 random(3);
  int allowed = 0;
  for (int run = 0; run < 200000; ++run) {
    // Half planes with some noise, so that both answers come.
    NodeLabels labels;
    const int cut = static_cast<int>(random() % 7), a = static_cast<int>(random() % 3),
              b = static_cast<int>(random() % 3);
    std::uint32_t signs = 0;
    for (int i = 0; i < 27; ++i) {
      bool inside = i % 3 + a * (i / 3 % 3) + b * (i / 9) > cut;
      if (random() % 20 == 0) inside = !inside;
      labels[static_cast<std::size_t>(i)] = inside ? 1 : 2;
      signs |= static_cast<std::uint32_t>(inside) << i;
    }
    ASSERT_EQ(labels_allow_collapse(labels), signs_allow_collapse(signs)) << signs;
    allowed += labels_allow_collapse(labels) ? 1 : 0;
  }
  EXPECT_GT(allowed, 1000);
}

// Every cell of up to four labels.
template <class F>
void each_cell(std::uint32_t labels, F&& f) {
  std::uint32_t count = 1;
  for (int i = 0; i < 8; ++i) count *= labels;
  for (std::uint32_t n = 0; n < count; ++n) {
    CellLabels cell;
    std::uint32_t rest = n;
    for (std::uint32_t& label : cell) {
      label = rest % labels;
      rest /= labels;
    }
    f(cell);
  }
}

// Each side of a polygon lies on a face between two cells, and stands for a crossing edge of that
// face. What a label's polygons leave unmatched there has to be nothing: for each pair of sheets
// the sides that enter the label equal those that leave it.
TEST(LabelTopology, EachLabelIsBalancedOnEveryFace) {
  each_cell(4, [](const CellLabels& cell) {
    const CellSheets sheets = label_sheets(cell);
    for (int face = 0; face < 6; ++face) {
      const int axis = face >> 1, base = (face & 1) << axis;
      const int b = 1 << (axis + 1) % 3, c = 1 << (axis + 2) % 3;
      const int corners[4] = {base, base | b, base | b | c, base | c};
      std::map<std::pair<int, std::uint32_t>, int> balance;  // sheet, label
      for (int i = 0; i < 4; ++i) {
        const int p = corners[i], q = corners[(i + 1) % 4];
        const std::uint32_t from = cell[static_cast<std::size_t>(p)],
                            to = cell[static_cast<std::size_t>(q)];
        if (from == to) continue;
        const int edge_axis = (p ^ q) == 1 ? 0 : (p ^ q) == 2 ? 1 : 2;
        const int sheet = sheets.sheet_of_edge[static_cast<std::size_t>(edge_at(edge_axis, p & q))];
        ASSERT_LT(sheet, 4);
        ++balance[{sheet, to}];
        --balance[{sheet, from}];
      }
      for (const auto& [key, sum] : balance) ASSERT_EQ(sum, 0);
    }
  });
}

TEST(LabelTopology, SheetsHaveThreeCrossingsAtLeastAndAreAtMostFour) {
  each_cell(4, [](const CellLabels& cell) {
    const CellSheets sheets = label_sheets(cell);
    ASSERT_LE(sheets.sheets, 4);
    std::array<int, 4> crossings{};
    for (std::size_t i = 0; i < sheets.crossings; ++i)
      ++crossings[sheets.sheet_of_edge[sheets.edges[i]]];
    for (std::size_t s = 0; s < sheets.sheets; ++s) ASSERT_GE(crossings[s], 3);
  });
}

TEST(LabelTopology, CellsThatCollapseHaveOneSheet) {
  std::array<int, 6> simplices{};
  each_cell(4, [&](const CellLabels& cell) {
    if (!labels_collapsible(cell)) return;
    ASSERT_EQ(label_sheets(cell).sheets, 1);
    ++simplices[std::set<std::uint32_t>(cell.begin(), cell.end()).size()];
  });
  EXPECT_EQ(simplices[1], 0);
  EXPECT_EQ(simplices[2], 126 / 2 * 12);  // ordered pairs of four labels
  EXPECT_GT(simplices[3], 0);
  EXPECT_GT(simplices[4], 0);
}

TEST(LabelTopology, KnownSimplices) {
  EXPECT_TRUE(labels_collapsible({0, 0, 0, 0, 0, 0, 0, 1}));
  EXPECT_TRUE(labels_collapsible({0, 1, 2, 2, 0, 1, 2, 2}));   // three columns meeting in a line
  EXPECT_FALSE(labels_collapsible({0, 1, 1, 2, 0, 1, 1, 2}));  // diagonal: not connected
  EXPECT_FALSE(labels_collapsible({0, 1, 2, 3, 0, 1, 2, 3}));  // four columns: a face of four
  EXPECT_TRUE(labels_collapsible({0, 1, 2, 2, 3, 3, 3, 3}));   // three over one: a tetrahedron
  EXPECT_FALSE(labels_collapsible({0, 0, 1, 1, 2, 2, 2, 2}) &&
               labels_collapsible({0, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_TRUE(labels_collapsible({0, 0, 1, 1, 2, 2, 2, 2}));
  EXPECT_FALSE(labels_collapsible({0, 1, 2, 3, 4, 4, 4, 4}));  // five
}

}  // namespace
}  // namespace voxweld
