#include "stages/encode/fragment_cut.h"

#include <algorithm>
#include <bit>
#include <optional>
#include <utility>

namespace voxweld {
namespace {

__extension__ using Wide128 = __int128;

std::int64_t floor_divide(Wide128 a, Wide128 b) {  // b > 0
  const Wide128 quotient = a / b;
  return static_cast<std::int64_t>(a % b < 0 ? quotient - 1 : quotient);
}

// Where the edge meets the plane, rounded to the grid. Its ends lie on either side.
GridPoint crossing(GridPoint a, GridPoint b, std::size_t axis, std::int64_t plane) {
  if (b < a) std::swap(a, b);  // for every triangle that has the edge the same way
  std::int64_t along = plane - a[axis], length = b[axis] - a[axis];
  if (length < 0) along = -along, length = -length;
  GridPoint p;
  for (std::size_t k = 0; k < 3; ++k)
    p[k] = a[k] + floor_divide(2 * static_cast<Wide128>(b[k] - a[k]) * along + length,
                               2 * static_cast<Wide128>(length));
  p[axis] = plane;
  return p;
}

struct Halves {
  std::vector<GridPoint> below, above;
};

using Sign = std::int8_t;

Sign side(std::int64_t v, std::int64_t plane) {
  return static_cast<Sign>((v > plane ? 1 : 0) - (v < plane ? 1 : 0));
}

// Cuts a ring that runs through the plane twice, there and back. Nothing where it does so more often: a
// ring of rounded points need not be convex.
std::optional<Halves> split(const std::vector<GridPoint>& ring, std::size_t axis,
                            std::int64_t plane) {
  std::vector<GridPoint> points;
  std::vector<Sign> sides;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const GridPoint &p = ring[i], &next = ring[(i + 1) % ring.size()];
    points.push_back(p);
    sides.push_back(side(p[axis], plane));
    if (sides.back() * side(next[axis], plane) >= 0) continue;
    points.push_back(crossing(p, next, axis, plane));
    sides.push_back(0);
  }
  // A way through the plane begins at the first of the points on it.
  const std::size_t n = points.size();
  if (n == 0) return std::nullopt;
  std::vector<std::size_t> ways;
  for (std::size_t i = 0; i < n; ++i) {
    const Sign before = sides[(i + n - 1) % n];
    if (sides[i] != 0 || before == 0) continue;
    std::size_t k = i;
    while (sides[k % n] == 0) ++k;
    if (sides[k % n] != before) ways.push_back(i);
  }
  if (ways.size() != 2) return std::nullopt;
  const auto between = [&](std::size_t from, std::size_t to) {
    std::vector<GridPoint> part;
    for (std::size_t i = from; i != to; i = (i + 1) % n) part.push_back(points[i]);
    part.push_back(points[to]);
    return part;
  };
  Halves halves{between(ways[0], ways[1]), between(ways[1], ways[0])};
  if (sides[(ways[0] + n - 1) % n] < 0) std::swap(halves.below, halves.above);
  return halves;
}

// The axis along which a ring is seen at its largest, and whether it runs clockwise then.
struct View {
  std::size_t u = 0, v = 1;
  int turn = 1;
};

Wide128 product(std::int64_t a, std::int64_t b) {
  return static_cast<Wide128>(a) * b;
}
Wide128 magnitude(Wide128 v) {
  return v < 0 ? -v : v;
}

View view_of(const std::vector<GridPoint>& ring) {
  std::array<Wide128, 3> normal{};
  for (std::size_t i = 1; i + 1 < ring.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t u = (k + 1) % 3, v = (k + 2) % 3;
      normal[k] += product(ring[i][u] - ring[0][u], ring[i + 1][v] - ring[0][v]) -
                   product(ring[i][v] - ring[0][v], ring[i + 1][u] - ring[0][u]);
    }
  std::size_t most = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (magnitude(normal[k]) > magnitude(normal[most])) most = k;
  return {(most + 1) % 3, (most + 2) % 3, normal[most] < 0 ? -1 : 1};
}

// Triangles that fill a ring of few points: of all ways the one whose smallest triangle is largest, as it
// is seen from the side, so that none folds over or has no area where that can be.
class RingFilling {
 public:
  explicit RingFilling(const std::vector<GridPoint>& ring)
      : ring_(ring), view_(view_of(ring)), n_(ring.size()), best_(n_ * n_), middle_(n_ * n_) {
    for (std::size_t width = 1; width < n_; ++width)
      for (std::size_t i = 0; i + width < n_; ++i) fill(i, i + width);
  }
  template <class Emit>
  void each(Emit emit) const {
    each(0, n_ - 1, emit);
  }

 private:
  Wide128 area(std::size_t a, std::size_t b, std::size_t c) const {
    const auto [u, v, turn] = view_;
    const GridPoint &p = ring_[a], &q = ring_[b], &r = ring_[c];
    return turn * (product(q[u] - p[u], r[v] - p[v]) - product(q[v] - p[v], r[u] - p[u]));
  }
  void fill(std::size_t i, std::size_t j) {
    Wide128& best = best_[i * n_ + j];
    best = j == i + 1 ? most : -most;
    for (std::size_t k = i + 1; k < j; ++k) {
      const Wide128 least = std::min({best_[i * n_ + k], best_[k * n_ + j], area(i, k, j)});
      if (least <= best) continue;
      best = least;
      middle_[i * n_ + j] = k;
    }
  }
  template <class Emit>
  void each(std::size_t i, std::size_t j, Emit& emit) const {
    if (j == i + 1) return;
    const std::size_t k = middle_[i * n_ + j];
    each(i, k, emit);
    emit(ring_[i], ring_[k], ring_[j]);
    each(k, j, emit);
  }

  static constexpr Wide128 most = static_cast<Wide128>(1) << 100;  // more than any area

  const std::vector<GridPoint>& ring_;
  const View view_;
  const std::size_t n_;
  std::vector<Wide128> best_;
  std::vector<std::size_t> middle_;
};

}  // namespace

std::int64_t FragmentCutter::slab_of(std::int64_t v) const {
  const std::int64_t fragment = v / fragment_range;
  if (grid_.lod == 0) return fragment;
  return 2 * fragment + (v % fragment_range >= fragment_middle ? 1 : 0);
}

std::int64_t FragmentCutter::plane(std::int64_t slab) const {
  if (grid_.lod == 0) return slab * fragment_range;
  return (slab >> 1) * fragment_range + (slab & 1) * fragment_middle;
}

std::uint32_t FragmentCutter::cell_of(std::int64_t slab) const {
  return static_cast<std::uint32_t>(grid_.lod == 0 ? slab : slab >> 1);
}

// What lies in a plane belongs to the lower slab, as clients have it for octants.
FragmentCutter::Slabs FragmentCutter::slabs(std::span<const GridPoint> ring,
                                            std::size_t axis) const {
  std::int64_t lo = ring[0][axis], hi = lo;
  for (const GridPoint& p : ring) {
    lo = std::min(lo, p[axis]);
    hi = std::max(hi, p[axis]);
  }
  std::int64_t last = slab_of(hi);
  if (hi == plane(last) && last > 0) --last;
  return {std::min(slab_of(lo), last), last};
}

std::span<const FragmentCutter::Piece> FragmentCutter::cut(
    const std::array<LatticePoint, 3>& corners) {
  pieces_.clear();
  const std::array<GridPoint, 3> triangle{grid_.of(corners[0]), grid_.of(corners[1]),
                                          grid_.of(corners[2])};
  if (!cut_whole(triangle)) cut_along({triangle.begin(), triangle.end()}, 0, {});
  return pieces_;
}

// Most triangles lie in one fragment.
bool FragmentCutter::cut_whole(const std::array<GridPoint, 3>& corners) {
  FragmentCell cell{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto [first, last] = slabs(corners, axis);
    if (first != last) return false;
    cell[axis] = cell_of(last);
  }
  emit(corners[0], corners[1], corners[2], cell);
  return true;
}

void FragmentCutter::cut_along(Ring ring, std::size_t axis, std::array<std::int64_t, 3> slab) {
  if (axis == 3) return finish(ring, slab);
  const auto [first, last] = slabs(ring, axis);
  for (std::int64_t s = first; s < last; ++s) {
    auto halves = split(ring, axis, plane(s + 1));
    if (!halves) return cut_apart(ring, axis, slab);
    slab[axis] = s;
    cut_along(std::move(halves->below), axis + 1, slab);
    ring = std::move(halves->above);
  }
  slab[axis] = last;
  cut_along(std::move(ring), axis + 1, slab);
}

// Triangle by triangle, which are convex.
void FragmentCutter::cut_apart(const Ring& ring, std::size_t axis,
                               std::array<std::int64_t, 3> slab) {
  RingFilling(ring).each([&](const GridPoint& a, const GridPoint& b, const GridPoint& c) {
    cut_along({a, b, c}, axis, slab);
  });
}

void FragmentCutter::finish(Ring& ring, const std::array<std::int64_t, 3>& slab) {
  // Points that fell together: edges without a length.
  ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
  while (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
  if (ring.size() < 3) return;  // its edges run there and back
  FragmentCell cell{};
  for (std::size_t k = 0; k < 3; ++k) cell[k] = cell_of(slab[k]);
  if (ring.size() == 3) return emit(ring[0], ring[1], ring[2], cell);
  RingFilling(ring).each(
      [&](const GridPoint& a, const GridPoint& b, const GridPoint& c) { emit(a, b, c, cell); });
}

void FragmentCutter::emit(const GridPoint& a, const GridPoint& b, const GridPoint& c,
                          const FragmentCell& cell) {
  if (a == b || b == c || c == a) return;  // the other two edges run there and back
  Piece piece{cell, {}};
  const std::array<const GridPoint*, 3> corners{&a, &b, &c};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      piece.corners[i][k] = static_cast<std::uint16_t>((*corners[i])[k] - cell[k] * fragment_range);
  pieces_.push_back(piece);
}

namespace {

// Those that have the corner: bit by octant.
std::uint8_t octants_with(const FragmentTriangle& corners) {
  constexpr std::array<std::uint8_t, 3> low{0b01010101, 0b00110011, 0b00001111};
  std::uint8_t mask = 0xff;
  for (const auto& p : corners)
    for (std::size_t k = 0; k < 3; ++k) {
      if (p[k] < fragment_middle) mask = static_cast<std::uint8_t>(mask & low[k]);
      if (p[k] > fragment_middle) mask = static_cast<std::uint8_t>(mask & ~low[k]);
    }
  return mask;
}

}  // namespace

// Of one across octants clients take the first.
std::uint8_t octant_of(const FragmentTriangle& corners) {
  const std::uint8_t mask = octants_with(corners);
  return mask == 0 ? 0 : static_cast<std::uint8_t>(std::countr_zero(mask));
}

bool crosses_octants(const FragmentTriangle& corners) {
  return octants_with(corners) == 0;
}

}  // namespace voxweld
