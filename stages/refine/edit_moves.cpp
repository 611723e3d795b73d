#include "stages/refine/edit_moves.h"

#include <algorithm>

#include "stages/exact/orientation.h"

namespace voxweld {
bool EditMoves::add(std::uint32_t triangle, const Corners& now, const LatticeTriangle& shape,
                    Change& out) {
  const Index3 plane = exact_normal(shape[0], shape[1], shape[2]);
  if (plane == Index3{}) return false;
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
  if (a == Freedom::free && b == Freedom::free) return EdgeEnds{std::max(u, v), std::min(u, v)};
  if (a == Freedom::free && b == Freedom::anchor) return EdgeEnds{u, v};
  if (a == Freedom::anchor && b == Freedom::free) return EdgeEnds{v, u};
  return std::nullopt;
}

bool EditMoves::linked(std::uint32_t u, std::uint32_t v) {
  star_u_.clear();
  star_v_.clear();
  mesh_.star(u, star_u_);
  mesh_.star(v, star_v_);
  if (star_u_.size() + star_v_.size() - 4 > most_around) return false;
  if (star_u_.size() == 3 && star_v_.size() == 3) return false;
  ++mark_;
  for (const std::uint32_t t : star_u_)
    for (const std::uint32_t w : mesh_.corners(t)) marks_[w] = mark_;
  marks_[u] = 0;
  std::size_t common = 0;
  for (const std::uint32_t t : star_v_)
    for (const std::uint32_t w : mesh_.corners(t)) {
      if (w == v || marks_[w] != mark_) continue;
      ++common;
      marks_[w] = 0;
    }
  return common == 2;
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
  std::size_t around_a = 0, around_b = 0;
  mesh_.each_around(b, [&](std::uint32_t t) {
    ++around_b;
    if (t == triangle || !uses(mesh_.corners(t), a)) return;
    other = t;
    for (const std::uint32_t w : mesh_.corners(t))
      if (w != a && w != b) opposite = w;
  });
  mesh_.each_around(a, [&](std::uint32_t) { ++around_a; });
  if (other == EditMesh::none || !mesh_.movable(other)) return false;
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
