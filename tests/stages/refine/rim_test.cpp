// What may be done where an open border ends a mesh.
#include <gtest/gtest.h>

#include "stages/refine/collapse.h"
#include "stages/refine/edit_moves.h"

namespace voxweld {
namespace rim {
namespace {

constexpr LatticeBox box{{0, 0, 0}, {1000, 1000, 1000}};
constexpr std::int32_t first = 100, side = 50, last = 500;  // of the sheet
constexpr std::int32_t count = (last - first) / side + 1;
// The volume ends where the sheet does.
constexpr LatticeBox samples{{first, first, first}, {last, last, last}};

// A flat one of count^2 vertices, which triangles may be left out of.
template <class Takes>
RefineMesh sheet(Takes&& takes) {
  RefineMesh mesh;
  for (std::int32_t y = 0; y < count; ++y)
    for (std::int32_t x = 0; x < count; ++x) {
      mesh.ids.push_back({mesh.positions.size()});
      mesh.positions.push_back({first + x * side, first + y * side, 300});
    }
  for (std::uint32_t y = 0; y + 1 < count; ++y)
    for (std::uint32_t x = 0; x + 1 < count; ++x) {
      const std::uint32_t a = y * count + x, b = a + 1, c = a + count, d = c + 1;
      for (const Corners& t : {Corners{a, b, d}, Corners{a, d, c}})
        if (takes(t)) mesh.triangles.push_back(t);
    }
  return mesh;
}
RefineMesh sheet() {
  return sheet([](const Corners&) { return true; });
}

RefineParameters collapsing(double tolerance) {
  RefineParameters parameters;
  parameters.tolerance = tolerance;
  parameters.reach = side;
  parameters.samples = samples;
  return parameters;
}

// Of the vertices that triangles use.
std::vector<LatticePoint> places_of(const RefineMesh& mesh) {
  std::vector<LatticePoint> places;
  for (const Corners& t : mesh.triangles)
    for (const std::uint32_t v : t) places.push_back(mesh.positions[v]);
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end()), places.end());
  return places;
}

TEST(Rim, OfAFlatSheetItsCornersStay) {
  EditMesh mesh(sheet(), box, samples);
  RefineCounts counts;
  collapse_edges(mesh, collapsing(1), CollapseCare::all, counts);
  const RefineMesh left = std::move(mesh).take();
  EXPECT_EQ(left.triangles.size(), 2u);
  EXPECT_EQ(places_of(left),
            (std::vector<LatticePoint>{
                {first, first, 300}, {first, last, 300}, {last, first, 300}, {last, last, 300}}));
}

// Two fans that meet in a vertex: as places are, triangles of the one and of the other would share an edge.
TEST(Rim, NoVertexComesToLieOnAnother) {
  RefineMesh made;
  made.positions = {
      {300, 300, 100}, {200, 300, 200}, {200, 350, 250}, {400, 300, 200}, {400, 350, 250}};
  for (std::uint64_t v = 0; v < made.positions.size(); ++v) made.ids.push_back({v});
  made.triangles = {{0, 1, 2}, {0, 3, 4}};
  EditMesh mesh(made, box, samples);
  ASSERT_EQ(mesh.freedom(1), Freedom::free);
  EditMoves moves(mesh);
  Change change;
  for (const std::uint32_t other : {3U, 4U}) {
    ASSERT_TRUE(moves.move(1, mesh.position(other), change));
    EXPECT_FALSE(mesh.clean(change));
    EXPECT_FALSE(mesh.clean_around(change));
    EXPECT_EQ(mesh.hits(change, 9), 1u);
  }
  LatticePoint beside = mesh.position(3);
  --beside[1];
  ASSERT_TRUE(moves.move(1, beside, change));
  EXPECT_TRUE(mesh.clean(change));
  EXPECT_EQ(mesh.hits(change, 9), 0u);
  // Where they do so already it is found.
  made.positions[1] = made.positions[3];
  EditMesh meeting(made, box, samples);
  EXPECT_EQ(meeting.find_intersecting(), (std::vector<std::uint32_t>{0, 1}));
  EXPECT_TRUE(meeting.hit(0, 1));
}

TEST(Rim, WhereNoBorderIsOpenItStays) {
  EditMesh mesh(sheet(), box);
  RefineCounts counts;
  collapse_edges(mesh, collapsing(1), CollapseCare::all, counts);
  const RefineMesh left = std::move(mesh).take();
  std::size_t at_the_end = 0;
  for (const LatticePoint& p : places_of(left))
    at_the_end += p[0] == first || p[0] == last || p[1] == first || p[1] == last ? 1 : 0;
  EXPECT_EQ(at_the_end, 4u * (count - 1));
}

// A notch that is deeper than the tolerance stays as it is.
TEST(Rim, KeepsItsLine) {
  RefineMesh mesh = sheet();
  const std::uint32_t notch = count / 2;
  mesh.positions[notch][1] += 20;
  EditMesh edit(mesh, box, samples);
  RefineCounts counts;
  collapse_edges(edit, collapsing(4), CollapseCare::all, counts);
  const std::vector<LatticePoint> left = places_of(std::move(edit).take());
  EXPECT_TRUE(std::ranges::binary_search(left, mesh.positions[notch]));
  EXPECT_LT(left.size(), 12u);
}

TEST(Rim, GoesAlongItselfOnly) {
  const EditMesh mesh(sheet(), box, samples);
  EditMoves moves(mesh);
  EXPECT_EQ(mesh.kind(1), StarKind::rim);
  EXPECT_EQ(mesh.freedom(1), Freedom::free);
  ASSERT_TRUE(moves.ends(1, 2));
  EXPECT_TRUE(moves.linked(1, 2));
  // Inner vertices come to it.
  const auto inwards = moves.ends(1, count + 1);
  ASSERT_TRUE(inwards);
  EXPECT_EQ(inwards->keep, 1u);
  EXPECT_TRUE(inwards->stays);
  // An edge from border to border would cut the sheet in two.
  const auto strip = sheet([](const Corners& t) { return t[2] < 2 * count; });
  const EditMesh narrow(strip, box, samples);
  EXPECT_EQ(narrow.kind(count + 2), StarKind::rim);
  EXPECT_FALSE(EditMoves(narrow).ends(1, count + 2));
}

// A hole of three edges would be closed by two triangles that lie one on the other.
TEST(Rim, AHoleStays) {
  const std::uint32_t a = 3 * count + 3;
  const Corners hole{a, a + 1, a + count + 1};
  const EditMesh mesh(sheet([&](const Corners& t) { return t != hole; }), box, samples);
  EditMoves moves(mesh);
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t u = hole[k], v = hole[(k + 1) % 3];
    EXPECT_EQ(mesh.kind(u), StarKind::rim);
    const auto ends = moves.ends(u, v);
    ASSERT_TRUE(ends);
    EXPECT_FALSE(moves.linked(ends->gone, ends->keep));
  }
}

TEST(Rim, DoesNotLeaveTheBorder) {
  const EditMesh mesh(sheet(), box, samples);
  const std::uint32_t middle = count / 2;
  const auto [x, y, z] = mesh.position(middle);
  EXPECT_TRUE(mesh.keeps_border(middle, {x + 10, y, z + 10}));
  EXPECT_TRUE(mesh.keeps_border(middle, {x, y - 10, z})) << "out of the volume";
  EXPECT_FALSE(mesh.keeps_border(middle, {x, y + 1, z}));
  EXPECT_TRUE(mesh.keeps_border(middle + 3 * count, {x, y + 1, z})) << "no rim";
  // One that lies further in, as of a large leaf, may not go further.
  const LatticeBox far{{first - 30, first - 30, 0}, {last + 30, last + 30, 1000}};
  const EditMesh inside(sheet(), box, far);
  EXPECT_TRUE(inside.keeps_border(middle, {x, y - 1, z}));
  EXPECT_FALSE(inside.keeps_border(middle, {x, y + 1, z}));
}

}  // namespace
}  // namespace rim
}  // namespace voxweld
