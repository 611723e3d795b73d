#include "stages/exact/triangle_pair.h"

#include <algorithm>
#include <utility>

#include "stages/exact/orientation.h"

namespace voxweld {
namespace {

struct Segment {
  const LatticePoint& p;
  const LatticePoint& q;
};

// A triangle with its plane.
struct Facet {
  const LatticeTriangle& corners;
  Index3 normal;

  explicit Facet(const LatticeTriangle& triangle)
      : corners(triangle), normal(exact_normal(triangle[0], triangle[1], triangle[2])) {}

  bool degenerate() const { return normal == Index3{}; }
  int side(const LatticePoint& s) const {
    return sign_of_dot(normal, lattice_vector(corners[0], s));
  }
  Segment edge(std::size_t i) const { return {corners[i], corners[(i + 1) % 3]}; }
  // An axis along which the triangle can be looked at and has an area.
  int view() const { return normal.x != 0 ? 0 : normal.y != 0 ? 1 : 2; }
};

// s lies on the line of the segment; whether between its ends, or at one.
bool between(const Segment& segment, const LatticePoint& s) {
  for (std::size_t a = 0; a < 3; ++a)
    if (s[a] < std::min(segment.p[a], segment.q[a]) || s[a] > std::max(segment.p[a], segment.q[a]))
      return false;
  return true;
}

// Both in one plane, seen along `view`.
bool meet_in_plane(const Segment& a, const Segment& b, int view) {
  const int p = orientation(b.p, b.q, a.p, view), q = orientation(b.p, b.q, a.q, view);
  const int r = orientation(a.p, a.q, b.p, view), s = orientation(a.p, a.q, b.q, view);
  if (p * q < 0 && r * s < 0) return true;
  return (p == 0 && between(b, a.p)) || (q == 0 && between(b, a.q)) ||
         (r == 0 && between(a, b.p)) || (s == 0 && between(a, b.q));
}

bool contains_in_plane(const Facet& facet, const LatticePoint& s) {
  const int turn = sign_of(facet.normal[facet.view()]);
  for (std::size_t i = 0; i < 3; ++i) {
    const Segment edge = facet.edge(i);
    if (orientation(edge.p, edge.q, s, facet.view()) * turn < 0) return false;
  }
  return true;
}

// p and q: on which side of the facet the segment's ends lie.
bool meets(const Segment& segment, const Facet& facet, int p, int q) {
  if (p * q > 0) return false;
  if (p == 0 && q == 0) {
    if (contains_in_plane(facet, segment.p)) return true;
    for (std::size_t i = 0; i < 3; ++i)
      if (meet_in_plane(segment, facet.edge(i), facet.view())) return true;
    return false;
  }
  // Its line passes the plane at one point, which is one of the segment. It is in the triangle where
  // the line passes all edges on the same side.
  bool left = false, right = false;
  for (std::size_t i = 0; i < 3; ++i) {
    const Segment edge = facet.edge(i);
    const int turn = orientation(segment.p, segment.q, edge.p, edge.q);
    left |= turn > 0;
    right |= turn < 0;
  }
  return !(left && right);
}

bool meets(const Segment& segment, const Facet& facet) {
  return meets(segment, facet, facet.side(segment.p), facet.side(segment.q));
}

bool any_edge_meets(const Facet& edges, const Facet& facet) {
  std::array<int, 3> side{};
  for (std::size_t i = 0; i < 3; ++i) side[i] = facet.side(edges.corners[i]);
  if (side[0] != 0 && side[0] == side[1] && side[1] == side[2]) return false;
  for (std::size_t i = 0; i < 3; ++i)
    if (meets(edges.edge(i), facet, side[i], side[(i + 1) % 3])) return true;
  return false;
}

// Turns both so that the corners that they share come first, and says how many these are.
int align(LatticeTriangle& a, LatticeTriangle& b) {
  int shared = 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (auto j = static_cast<std::size_t>(shared); j < 3; ++j)
      if (a[i] == b[j]) {
        std::swap(a[static_cast<std::size_t>(shared)], a[i]);
        std::swap(b[static_cast<std::size_t>(shared)], b[j]);
        ++shared;
        break;
      }
  return shared;
}

bool boxes_part(const LatticeTriangle& a, const LatticeTriangle& b) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto [a_lo, a_hi] = std::minmax({a[0][axis], a[1][axis], a[2][axis]});
    const auto [b_lo, b_hi] = std::minmax({b[0][axis], b[1][axis], b[2][axis]});
    if (a_hi < b_lo || b_hi < a_lo) return true;
  }
  return false;
}

}  // namespace

bool has_no_area(const LatticeTriangle& triangle) {
  return Facet(triangle).degenerate();
}

bool intersect_beyond_shared(const LatticeTriangle& first, const LatticeTriangle& second) {
  if (boxes_part(first, second)) return false;
  LatticeTriangle a = first, b = second;
  const int shared = align(a, b);
  const Facet facet_a(a), facet_b(b);
  if (facet_a.degenerate() || facet_b.degenerate()) return false;
  switch (shared) {
    case 0:
      return any_edge_meets(facet_a, facet_b) || any_edge_meets(facet_b, facet_a);
    case 1:
      // What they have in common is convex and holds the corner. So it is a star around it, and where
      // there is more it reaches the opposite edge of one of them.
      return meets({a[1], a[2]}, facet_b) || meets({b[1], b[2]}, facet_a);
    case 2: {
      if (facet_a.side(b[2]) != 0) return false;
      const int view = facet_a.view();
      return orientation(a[0], a[1], a[2], view) == orientation(a[0], a[1], b[2], view);
    }
    default:
      return true;
  }
}

}  // namespace voxweld
