#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <map>

#include "stages/encode/fragment_codec.h"
#include "stages/encode/fragment_cut.h"
#include "stages/encode/fragment_index.h"
#include "storage/support/error.h"
#include "tests/support/shapes.h"

namespace voxweld {
namespace {

using Corners = std::array<LatticePoint, 3>;
using Edge = std::pair<GridPoint, GridPoint>;

GridPoint on_grid(const FragmentCutter::Piece& piece, std::size_t corner) {
  GridPoint p{};
  for (std::size_t k = 0; k < 3; ++k)
    p[k] = piece.cell[k] * fragment_range + piece.corners[corner][k];
  return p;
}

std::vector<FragmentCutter::Piece> cut_all(const std::vector<Corners>& triangles,
                                           FragmentGrid grid) {
  FragmentCutter cutter(grid);
  std::vector<FragmentCutter::Piece> all;
  for (const Corners& t : triangles)
    for (const auto& piece : cutter.cut(t)) all.push_back(piece);
  return all;
}

// How often each edge is used one way more than the other: nothing is left of a closed mesh.
std::map<Edge, int> open_edges(const std::vector<FragmentCutter::Piece>& pieces) {
  std::map<Edge, int> balance;
  for (const auto& piece : pieces)
    for (std::size_t i = 0; i < 3; ++i) {
      const GridPoint a = on_grid(piece, i), b = on_grid(piece, (i + 1) % 3);
      if (a < b)
        ++balance[{a, b}];
      else
        --balance[{b, a}];
    }
  std::erase_if(balance, [](const auto& one) { return one.second == 0; });
  return balance;
}

double volume6(const std::vector<FragmentCutter::Piece>& pieces) {
  double sum = 0;
  for (const auto& piece : pieces) {
    std::array<std::array<double, 3>, 3> p{};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k) p[i][k] = static_cast<double>(on_grid(piece, i)[k]);
    for (std::size_t k = 0; k < 3; ++k)
      sum +=
          p[0][k] * (p[1][(k + 1) % 3] * p[2][(k + 2) % 3] - p[1][(k + 2) % 3] * p[2][(k + 1) % 3]);
  }
  return sum;
}

std::vector<Corners> corners_of(const TileMesh& mesh) {
  std::vector<Corners> all;
  for (const auto& t : mesh.triangles)
    all.push_back({mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]});
  return all;
}

// A closed mesh of any four points.
void add_tetrahedron(std::vector<Corners>& all, const std::array<LatticePoint, 4>& p) {
  for (const auto& [a, b, c] : {std::array{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}})
    all.push_back({p[static_cast<std::size_t>(a)], p[static_cast<std::size_t>(b)],
                   p[static_cast<std::size_t>(c)]});
}

void check_pieces(const std::vector<FragmentCutter::Piece>& pieces, int lod) {
  for (const auto& piece : pieces) {
    const auto& c = piece.corners;
    ASSERT_TRUE(c[0] != c[1] && c[1] != c[2] && c[2] != c[0]);
    ASSERT_TRUE(lod == 0 || !crosses_octants(c));
  }
}

TEST(FragmentCut, KeepsAWholeTriangleWhereItIs) {
  FragmentCutter cutter({257, 0});  // a step is 255 on the grid
  const auto pieces = cutter.cut({LatticePoint{300, 10, 0}, {310, 10, 1}, {514, 20, 2}});
  ASSERT_EQ(pieces.size(), 1u);
  EXPECT_EQ(pieces[0].cell, (FragmentCell{1, 0, 0}));
  EXPECT_EQ(pieces[0].corners[0], (std::array<std::uint16_t, 3>{43 * 255, 2550, 0}));
  EXPECT_EQ(pieces[0].corners[2], (std::array<std::uint16_t, 3>{65535, 5100, 510}));
}

TEST(FragmentCut, CutsAlongAPlaneByHand) {
  FragmentCutter cutter({65535, 0});  // the grid is the lattice
  const auto cut = cutter.cut({LatticePoint{65534, 0, 0}, {65537, 0, 0}, {65534, 3, 0}});
  const std::vector<FragmentCutter::Piece> pieces(cut.begin(), cut.end());
  ASSERT_EQ(pieces.size(), 3u);  // a quad below, a triangle above
  EXPECT_EQ(volume6(pieces), 0);
  for (const auto& piece : pieces) {
    const bool above = piece.cell == FragmentCell{1, 0, 0};
    EXPECT_TRUE(above || piece.cell == (FragmentCell{0, 0, 0}));
    if (!above) continue;
    EXPECT_EQ(piece.corners, (FragmentTriangle{{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}}));
  }
  EXPECT_EQ(open_edges(pieces).size(), 5u);  // two of three sides are cut
}

TEST(FragmentCut, LaysWhatIsInAPlaneIntoTheLowerFragment) {
  FragmentCutter cutter({65535, 0});
  const auto upper = cutter.cut({LatticePoint{65535, 1, 1}, {65535, 5, 1}, {65535, 1, 5}});
  ASSERT_EQ(upper.size(), 1u);
  EXPECT_EQ(upper[0].cell, (FragmentCell{0, 0, 0}));
  const auto lowest = cutter.cut({LatticePoint{0, 1, 1}, {0, 5, 1}, {0, 1, 5}});
  ASSERT_EQ(lowest.size(), 1u);
  EXPECT_EQ(lowest[0].cell, (FragmentCell{0, 0, 0}));
}

TEST(FragmentCut, KeepsATorusClosedAtEachLevel) {
  const TileMesh torus = testing::make_torus({}, testing::small_lattice());
  const std::vector<Corners> triangles = corners_of(torus);
  for (const std::int32_t chunk : {257, 85, 51, 15})
    for (const int lod : {0, 1, 2, 5}) {
      const auto pieces = cut_all(triangles, {chunk, lod});
      ASSERT_GT(pieces.size(), 0u);
      check_pieces(pieces, lod);
      EXPECT_TRUE(open_edges(pieces).empty()) << chunk << " " << lod;
      if (lod > 0) continue;
      EXPECT_GT(pieces.size(), triangles.size());
      const std::int64_t steps = fragment_range / chunk;
      const auto step = static_cast<double>(steps);
      const double whole = volume6(cut_all(triangles, {65535, 0})) * step * step * step;
      EXPECT_NEAR(volume6(pieces) / whole, 1, 1e-5) << chunk;
    }
}

TEST(FragmentCut, KeepsAnyTetrahedraClosed) {
  EXPECT_TRUE(rc::check([] {
    const auto side = *rc::gen::element(4, 60, 3000, 1 << 22);
    const auto coordinate = rc::gen::inRange(0, side);
    const int lod = *rc::gen::inRange(0, 6);
    // So that not too many fragments are cut.
    std::vector<std::int32_t> chunks;
    for (const std::int32_t chunk : fragment_chunks)
      if ((static_cast<std::int64_t>(chunk) << lod) * 40 > side) chunks.push_back(chunk);
    if (chunks.empty()) chunks.push_back(65535);
    const std::int32_t chunk = *rc::gen::elementOf(chunks);
    std::vector<Corners> triangles;
    for (int i = 0; i < 4; ++i) {
      std::array<LatticePoint, 4> p;
      for (auto& q : p)
        for (auto& x : q) x = *coordinate;
      add_tetrahedron(triangles, p);
    }
    const auto pieces = cut_all(triangles, {chunk, lod});
    check_pieces(pieces, lod);
    RC_ASSERT(open_edges(pieces).empty());
  }));
}

TEST(FragmentCut, KnowsOctants) {
  const std::uint16_t low = 32767, middle = 32768, high = 32769;
  EXPECT_EQ(octant_of({{{high, 0, 0}, {middle, 0, 0}, {middle, 1, 0}}}), 1);
  EXPECT_EQ(octant_of({{{high, 0, high}, {middle, middle, middle}, {high, low, high}}}), 5);
  EXPECT_EQ(octant_of({{{middle, 0, 0}, {middle, 9, 0}, {middle, 0, 9}}}), 0);  // in a plane
  EXPECT_FALSE(crosses_octants({{{low, 0, 0}, {middle, 9, 0}, {low, 0, 9}}}));
  EXPECT_TRUE(crosses_octants({{{low, 0, 0}, {high, 9, 0}, {low, 0, 9}}}));
}

TEST(FragmentCodec, GivesBackWhatClientsRead) {
  const TileMesh torus = testing::make_torus({}, testing::small_lattice());
  std::vector<FragmentTriangle> soup;
  for (const auto& piece : cut_all(corners_of(torus), {4369, 1})) soup.push_back(piece.corners);
  const FragmentMesh mesh = weld_fragment(soup);
  EXPECT_LT(mesh.positions.size(), mesh.triangles.size());
  const std::vector<std::byte> bytes = encode_fragment(mesh);
  EXPECT_EQ(bytes, encode_fragment(mesh));
  const FragmentMesh read = decode_fragment(bytes, "f");
  const auto sorted = [](const FragmentMesh& of) {
    std::vector<std::array<std::array<std::int32_t, 3>, 3>> all;
    for (const auto& t : of.triangles) {
      auto& corners = all.emplace_back();
      for (std::size_t i = 0; i < 3; ++i) corners[i] = of.positions[t[i]];
      std::rotate(corners.begin(), std::ranges::min_element(corners), corners.end());
    }
    std::ranges::sort(all);
    return all;
  };
  EXPECT_EQ(sorted(read), sorted(mesh));
  for (std::size_t length = 0; length < bytes.size(); length += 97)
    EXPECT_THROW(decode_fragment(std::span(bytes).first(length), "f"), FormatError) << length;
}

// Edges of three triangles, a point where two fans meet, both sides of one triangle.
TEST(FragmentCodec, GivesBackWhatIsNoManifold) {
  FragmentMesh mesh;
  mesh.positions = {{0, 0, 0}, {9, 0, 0}, {0, 9, 0}, {0, 0, 9}, {9, 9, 9}, {7, 7, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}, {2, 4, 5}, {0, 2, 1}, {3, 4, 5}};
  const FragmentMesh read = decode_fragment(encode_fragment(mesh), "f");
  EXPECT_EQ(read.triangles.size(), mesh.triangles.size());
}

TEST(FragmentIndex, IsReadBack) {
  FragmentIndex index{{2, 2, 2}, {-1, 0, 1}, {}};
  index.levels = {{1.5F, {{0, 10, 0}, {9, 20, 0}}}, {3, {{0, 5, 0}, {1, 0, 0}}}};
  const std::vector<std::byte> bytes = index_bytes(index);
  EXPECT_EQ(bytes.size(), 12u + 12 + 4 + 2 * (4 + 12 + 4) + 4 * 16);
  const FragmentIndex read = read_index(bytes, "i");
  EXPECT_EQ(read.chunk_shape, index.chunk_shape);
  EXPECT_EQ(read.grid_origin, index.grid_origin);
  ASSERT_EQ(read.levels.size(), 2u);
  EXPECT_EQ(read.levels[1].scale, 3);
  EXPECT_EQ(read.levels[0].fragments, index.levels[0].fragments);
  EXPECT_EQ(read.levels[1].fragments, index.levels[1].fragments);
  for (std::size_t length = 0; length < bytes.size(); ++length)
    EXPECT_THROW(read_index(std::span(bytes).first(length), "i"), FormatError) << length;
}

TEST(FragmentIndex, HasWhatClientsLookThrough) {
  // A fragment alone below, and one above whose second octant has nothing below it.
  std::vector<FragmentLevel> levels{{1, {{17, 5, 0}}}, {2, {{0, 5, 0b10}}}, {4, {}}};
  add_empty_fragments(levels);
  EXPECT_EQ(levels[0].fragments, (std::vector<FragmentEntry>{{1, 0, 0}, {17, 5, 0}}));
  EXPECT_EQ(levels[1].fragments, (std::vector<FragmentEntry>{{0, 5, 0b10}, {2, 0, 0}}));
  EXPECT_EQ(levels[2].fragments, (std::vector<FragmentEntry>{{0, 0, 0}}));
}

}  // namespace
}  // namespace voxweld
