#include "stages/contouring/cell_topology.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

namespace voxweld {
namespace {

TEST(CellTopology, CountsKnownFromTheLiterature) {
  int problem = 0, collapse = 0, most = 0;
  for (unsigned s = 0; s < 256; ++s) {
    const auto signs = static_cast<CellSigns>(s);
    problem += problem_face(signs) >= 0 ? 1 : 0;
    collapse += collapsible(signs) ? 1 : 0;
    const int apart = cell_sheets(signs, false).sheets, joined = cell_sheets(signs, true).sheets;
    EXPECT_EQ(most_sheets(signs), std::max(apart, joined)) << s;
    most = std::max(most, apart);
  }
  EXPECT_EQ(problem, 36);
  EXPECT_EQ(collapse, 126);
  EXPECT_EQ(most, 4);
}

TEST(CellTopology, CollapsibleCellsHaveOneSheetAndNoAmbiguousFace) {
  for (unsigned s = 0; s < 256; ++s) {
    if (!collapsible(static_cast<CellSigns>(s))) continue;
    EXPECT_EQ(cell_sheets(static_cast<CellSigns>(s), false).sheets, 1) << s;
    EXPECT_LT(problem_face(static_cast<CellSigns>(s)), 0) << s;
  }
}

TEST(CellTopology, EveryCrossingHasASheetAndSheetsAreNumberedByLowestEdge) {
  for (unsigned s = 0; s < 256; ++s)
    for (const bool joined : {false, true}) {
      const CellSheets& cell = cell_sheets(static_cast<CellSigns>(s), joined);
      int next = 0, crossings = 0;
      for (int e = 0; e < 12; ++e) {
        const EdgeCorners ends = edge_corners(e);
        const bool crosses = (s >> ends.low & 1) != (s >> ends.high & 1);
        const int sheet = cell.sheet_of_edge[static_cast<std::size_t>(e)];
        EXPECT_EQ(crosses, sheet != 255);
        if (!crosses) continue;
        ++crossings;
        EXPECT_LE(sheet, next);
        next = std::max(next, sheet + 1);
      }
      EXPECT_EQ(next, cell.sheets);
      EXPECT_EQ(crossings, cell.crossings);
    }
}

TEST(CellTopology, JoiningAProblemFaceSplitsItsSheet) {
  for (unsigned s = 0; s < 256; ++s) {
    const auto signs = static_cast<CellSigns>(s);
    if (problem_face(signs) < 0) continue;
    EXPECT_EQ(cell_sheets(signs, true).sheets, cell_sheets(signs, false).sheets + 1) << s;
  }
}

TEST(CellTopology, EdgesAndCorners) {
  for (int e = 0; e < 12; ++e) {
    const EdgeCorners ends = edge_corners(e);
    EXPECT_EQ(ends.low ^ ends.high, 1 << (e >> 2));
    EXPECT_EQ(edge_at(e >> 2, ends.low), e);
  }
}

// The 27 signs with the plane x < 1 inside: corners and middles agree.
TEST(CellTopology, CollapseTestOnPlanesAndBlobs) {
  std::uint32_t plane = 0;
  for (int i = 0; i < 27; ++i)
    if (i % 3 == 0) plane |= 1u << i;
  EXPECT_TRUE(signs_allow_collapse(plane));
  EXPECT_TRUE(signs_allow_collapse(~plane & ((1u << 27) - 1)));
  EXPECT_FALSE(signs_allow_collapse(0));
  EXPECT_FALSE(signs_allow_collapse((1u << 27) - 1));
  // An edge's middle differs from both its ends.
  EXPECT_FALSE(signs_allow_collapse(plane ^ (1u << 3)));
  // A face's middle differs from its four corners.
  EXPECT_FALSE(signs_allow_collapse(plane ^ (1u << 12)));
  // The middle of a face whose corners differ may be either.
  EXPECT_TRUE(signs_allow_collapse(plane ^ (1u << 4)));
}

TEST(CellTopology, Signs27GatherFromChildren) {
  const std::uint32_t signs = 0x5a3c7e1 & ((1u << 27) - 1);
  std::array<CellSigns, 8> children{};
  for (int child = 0; child < 8; ++child)
    for (int corner = 0; corner < 8; ++corner) {
      const int x = (child & 1) + (corner & 1), y = (child >> 1 & 1) + (corner >> 1 & 1),
                z = (child >> 2) + (corner >> 2);
      const auto sign = signs >> (x + 3 * y + 9 * z) & 1u;
      children[static_cast<std::size_t>(child)] |= static_cast<CellSigns>(sign << corner);
    }
  EXPECT_EQ(gather_signs27(children), signs);
}

}  // namespace
}  // namespace voxweld
