// What the triangles around a vertex look like, by their opposite edges.
#include "stages/refine/vertex_star.h"

#include <gtest/gtest.h>

#include <vector>

namespace voxweld {
namespace {

constexpr MaterialPair ab{1, 2}, ac{1, 3}, bc{2, 3};

// Along these nodes.
void add_page(std::vector<LinkEdge>& link, const std::vector<std::uint32_t>& nodes,
              MaterialPair sides) {
  for (std::size_t i = 1; i < nodes.size(); ++i) link.push_back({nodes[i - 1], nodes[i], sides});
}

std::vector<LinkEdge> pages(const std::vector<std::uint32_t>& a,
                            const std::vector<std::uint32_t>& b,
                            const std::vector<std::uint32_t>& c) {
  std::vector<LinkEdge> link;
  add_page(link, a, ab);
  add_page(link, b, ac);
  add_page(link, c, bc);
  return link;
}

TEST(VertexStar, ARingIsADisc) {
  std::vector<LinkEdge> link;
  add_page(link, {5, 9, 2, 7, 5}, ab);
  EXPECT_EQ(kind_of_star(link), StarKind::disc);
  link[1].sides = ac;
  EXPECT_EQ(kind_of_star(link), StarKind::point) << "of two pairs";
  link[1] = {2, 9, ab};
  EXPECT_EQ(kind_of_star(link), StarKind::point) << "wound both ways";
}

TEST(VertexStar, ThreePagesMeetInALine) {
  EXPECT_EQ(kind_of_star(pages({1, 10, 11, 2}, {1, 20, 2}, {2, 30, 31, 32, 1})), StarKind::line);
  EXPECT_EQ(kind_of_star(pages({1, 10, 2}, {1, 2}, {2, 30, 1})), StarKind::line)
      << "one triangle is a page";
  EXPECT_EQ(kind_of_star(pages({1, 10, 2}, {1, 2}, {2, 1})), StarKind::point)
      << "two triangles of the same corners";
  auto link = pages({1, 10, 2}, {1, 20, 2}, {2, 30, 1});
  add_page(link, {2, 40, 1}, ab);
  EXPECT_EQ(kind_of_star(link), StarKind::line) << "four pages";
  link[0].sides = bc;
  EXPECT_EQ(kind_of_star(link), StarKind::point) << "a page of two pairs";
}

TEST(VertexStar, OneFanIsARim) {
  for (const std::vector<std::uint32_t>& nodes :
       {std::vector<std::uint32_t>{1, 2}, {1, 2, 3}, {4, 3, 2, 1}, {1, 2, 3, 4, 5}}) {
    std::vector<LinkEdge> fan;
    add_page(fan, nodes, ab);
    EXPECT_EQ(kind_of_star(fan), StarKind::rim) << nodes.size();
    std::ranges::reverse(fan);
    EXPECT_EQ(kind_of_star(fan), StarKind::rim) << nodes.size();
  }
  std::vector<LinkEdge> fans;
  add_page(fans, {1, 2, 3}, ab);
  add_page(fans, {4, 5}, ab);
  EXPECT_EQ(kind_of_star(fans), StarKind::point) << "two of them";
  std::vector<LinkEdge> touched;
  add_page(touched, {1, 2, 3}, ab);
  add_page(touched, {4, 5, 6, 4}, ab);
  EXPECT_EQ(kind_of_star(touched), StarKind::point) << "one that a sheet touches";
  std::vector<LinkEdge> mixed;
  add_page(mixed, {1, 2, 3}, ab);
  mixed[1].sides = bc;
  EXPECT_EQ(kind_of_star(mixed), StarKind::point) << "of two pairs";
  std::vector<LinkEdge> turned;
  add_page(turned, {1, 2, 3}, ab);
  std::swap(turned[1].from, turned[1].to);
  EXPECT_EQ(kind_of_star(turned), StarKind::point) << "of two directions";
}

TEST(VertexStar, AllElseIsAPoint) {
  EXPECT_EQ(kind_of_star({}), StarKind::point);
  std::vector<LinkEdge> two;
  add_page(two, {1, 2, 3, 1}, ab);
  add_page(two, {4, 5, 6, 4}, ab);
  EXPECT_EQ(kind_of_star(two), StarKind::point) << "two sheets that touch";
  auto book = pages({1, 10, 2}, {1, 20, 2}, {2, 30, 1});
  add_page(book, {4, 5, 6, 4}, ab);
  EXPECT_EQ(kind_of_star(book), StarKind::point) << "a sheet touches the line";
  // Six sheets between four lines.
  std::vector<LinkEdge> corner;
  for (std::uint32_t a = 0; a < 4; ++a)
    for (std::uint32_t b = a + 1; b < 4; ++b) add_page(corner, {a, 10 * a + b + 10, b}, {a, b});
  EXPECT_EQ(kind_of_star(corner), StarKind::point);
  // Lines that end here: rings that hang on one sheet.
  std::vector<LinkEdge> loops;
  add_page(loops, {1, 10, 11, 1}, ab);
  add_page(loops, {2, 20, 21, 2}, ac);
  add_page(loops, {1, 30, 2}, bc);
  EXPECT_EQ(kind_of_star(loops), StarKind::point);
}

}  // namespace
}  // namespace voxweld
