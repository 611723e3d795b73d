#include "stages/refine/edit_moves.h"

#include <algorithm>

#include "stages/exact/orientation.h"

namespace voxweld {
bool EditMoves::add(std::uint32_t triangle, const Corners& now, const LatticeTriangle& shape,
                    Change& out) {
  const Index3 plane = exact_normal(shape[0], shape[1], shape[2]);
  if (plane == Index3{} || out.now.size() == Change::most) return false;
  out.old.push_back(triangle);
  out.now.push_back(now);
  out.shapes.push_back(shape);
  out.planes.push_back(plane);
  return true;
}

bool EditMoves::move(std::uint32_t v, const LatticePoint& at, Change& out) {
  out.clear();
  bool sound = true;
  mesh_.each_around(v, [&](std::uint32_t t) {
    const Corners& c = mesh_.corners(t);
    LatticeTriangle shape = mesh_.shape(c);
    for (std::size_t k = 0; k < 3; ++k)
      if (c[k] == v) shape[k] = at;
    sound = sound && add(t, c, shape, out);
  });
  return sound;
}

void EditMoves::ring(std::uint32_t v, std::vector<std::uint32_t>& out) const {
  out.clear();
  mesh_.each_around(v, [&](std::uint32_t t) {
    for (const std::uint32_t w : mesh_.corners(t))
      if (w != v) out.push_back(w);
  });
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
}

std::optional<EdgeEnds> EditMoves::ends(std::uint32_t u, std::uint32_t v) const {
  const Freedom a = mesh_.freedom(u), b = mesh_.freedom(v);
  if (a == Freedom::fixed || b == Freedom::fixed) return std::nullopt;
  const StarKind of_u = mesh_.kind(u), of_v = mesh_.kind(v);
  EdgeEnds ends{std::max(u, v), std::min(u, v), false};
  if (of_u != of_v)
    ends = of_u < of_v ? EdgeEnds{u, v, true} : EdgeEnds{v, u, true};
  else if (a != Freedom::free || b != Freedom::free)
    ends = a == Freedom::free ? EdgeEnds{u, v, true} : EdgeEnds{v, u, true};
  if (!mesh_.may_go(ends.gone)) return std::nullopt;
  const StarKind gone = mesh_.kind(ends.gone);
  if (gone == StarKind::line && mesh_.around_edge(u, v) == 2) return std::nullopt;
  if (gone == StarKind::rim && mesh_.around_edge(u, v) != 1) return std::nullopt;
  return ends;
}

bool EditMoves::linked(std::uint32_t u, std::uint32_t v) {
  star_u_.clear();
  star_v_.clear();
  mesh_.star(u, star_u_);
  mesh_.star(v, star_v_);
  const bool one_sheet = mesh_.kind(v) == StarKind::disc;
  const std::size_t between = mesh_.around_edge(u, v);
  if (star_u_.size() + star_v_.size() - 2 * between >
      (one_sheet ? most_around : most_where_sheets_meet))
    return false;
  if (one_sheet && star_u_.size() == 3 && star_v_.size() == 3) return false;
  ++mark_;
  for (const std::uint32_t t : star_u_)
    for (const std::uint32_t w : mesh_.corners(t)) marks_[w] = mark_;
  marks_[u] = 0;
  common_.clear();
  for (const std::uint32_t t : star_v_)
    for (const std::uint32_t w : mesh_.corners(t)) {
      if (w == v || marks_[w] != mark_) continue;
      common_.push_back(w);
      marks_[w] = 0;
    }
  return common_.size() == between && (one_sheet || sheets_stay_apart(u, v));
}

// The rest of the link condition where v lies on several sheets. In one of them it follows from the
// count of common neighbours.
bool EditMoves::sheets_stay_apart(std::uint32_t u, std::uint32_t v) const {
  const auto is_common = [&](std::uint32_t w) { return std::ranges::count(common_, w) != 0; };
  // No triangle of u would come upon one of v.
  for (const std::uint32_t t : star_u_) {
    const Corners& c = mesh_.corners(t);
    const std::size_t k = corner_of(c, u);
    const std::uint32_t x = c[(k + 1) % 3], y = c[(k + 2) % 3];
    if (!is_common(x) || !is_common(y)) continue;
    for (const std::uint32_t other : star_v_)
      if (uses(mesh_.corners(other), x) && uses(mesh_.corners(other), y)) return false;
  }
  // No two lines would become one.
  return std::ranges::none_of(common_, [&](std::uint32_t w) {
    return mesh_.around_edge(u, w) != 2 && mesh_.around_edge(v, w) != 2;
  });
}

bool EditMoves::collapse(std::uint32_t u, std::uint32_t v, const LatticePoint& at, Change& out) {
  out.clear();
  const auto add_star = [&](const std::vector<std::uint32_t>& star, std::uint32_t other) {
    return std::ranges::all_of(star, [&](std::uint32_t t) {
      Corners c = mesh_.corners(t);
      if (uses(c, other)) return true;
      LatticeTriangle shape = mesh_.shape(c);
      for (std::size_t k = 0; k < 3; ++k)
        if (c[k] == u || c[k] == v) {
          c[k] = v;
          shape[k] = at;
        }
      return add(t, c, shape, out);
    });
  };
  if (!add_star(star_u_, v)) return false;
  // Those of v need no look where it stays.
  if (mesh_.position(v) != at && !add_star(star_v_, u)) return false;
  for (const std::uint32_t t : star_u_)
    if (uses(mesh_.corners(t), v)) out.old.push_back(t);
  return !out.now.empty();
}

bool EditMoves::flip(std::uint32_t triangle, std::size_t k, Change& out) {
  out.clear();
  const Corners& c = mesh_.corners(triangle);
  const std::uint32_t a = c[k], b = c[(k + 1) % 3], far = c[(k + 2) % 3];
  std::uint32_t other = EditMesh::none, opposite = EditMesh::none;
  std::size_t around_a = 0, around_b = 0, others = 0;
  mesh_.each_around(b, [&](std::uint32_t t) {
    ++around_b;
    if (t == triangle || !uses(mesh_.corners(t), a)) return;
    ++others;
    other = t;
    for (const std::uint32_t w : mesh_.corners(t))
      if (w != a && w != b) opposite = w;
  });
  mesh_.each_around(a, [&](std::uint32_t) { ++around_a; });
  if (others != 1 || !mesh_.movable(other) || mesh_.sides(other) != mesh_.sides(triangle))
    return false;
  if (around_a < 4 || around_b < 4) return false;
  bool joined = opposite == far;
  mesh_.each_around(far,
                    [&](std::uint32_t t) { joined = joined || uses(mesh_.corners(t), opposite); });
  if (joined) return false;
  const Corners first{a, opposite, far}, second{opposite, b, far};
  return add(triangle, first, mesh_.shape(first), out) &&
         add(other, second, mesh_.shape(second), out);
}

}  // namespace voxweld
