#include "stages/refine/edit_mesh.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace voxweld {
namespace {

// Of each vertex its place by id.
std::vector<std::uint32_t> places_by_id(const std::vector<VertexId>& ids) {
  std::vector<std::pair<VertexId, std::uint32_t>> order;
  order.reserve(ids.size());
  for (const VertexId id : ids) order.emplace_back(id, static_cast<std::uint32_t>(order.size()));
  std::sort(order.begin(), order.end());
  std::vector<std::uint32_t> places(ids.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) places[order[i].second] = i;
  return places;
}

template <class T>
std::vector<T> moved(const std::vector<T>& from, const std::vector<std::uint32_t>& places) {
  std::vector<T> to(from.size());
  for (std::size_t i = 0; i < from.size(); ++i) to[places[i]] = from[i];
  return to;
}

// Triangles by their corners, each with its number in the mesh. Few have the same first one, so they
// are put there at once.
using NumberedCorners = std::pair<Corners, std::uint32_t>;
std::vector<NumberedCorners> by_corners(const RefineMesh& mesh,
                                        const std::vector<std::uint32_t>& places) {
  std::vector<std::uint32_t> ends(places.size() + 1);
  for (const auto& c : mesh.triangles) ++ends[places[c[0]] + 1];
  std::partial_sum(ends.begin(), ends.end(), ends.begin());
  std::vector<NumberedCorners> sorted(mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& c = mesh.triangles[t];
    const Corners corners{places[c[0]], places[c[1]], places[c[2]]};
    sorted[ends[corners[0]]++] = {corners, t};
  }
  for (std::size_t begin = 0, end = 0; begin < sorted.size(); begin = end) {
    while (end < sorted.size() && sorted[end].first[0] == sorted[begin].first[0]) ++end;
    std::sort(sorted.begin() + static_cast<std::ptrdiff_t>(begin),
              sorted.begin() + static_cast<std::ptrdiff_t>(end));
  }
  return sorted;
}

}  // namespace

EditMesh::EditMesh(const RefineMesh& mesh, const LatticeBox& box,
                   const std::optional<LatticeBox>& samples)
    : box_(box), samples_box_(samples) {
  const auto n = static_cast<std::uint32_t>(mesh.positions.size());
  const auto m = static_cast<std::uint32_t>(mesh.triangles.size());
  const std::vector<std::uint32_t> places = places_by_id(mesh.ids);
  positions_ = moved(mesh.positions, places);
  ids_ = moved(mesh.ids, places);
  if (!mesh.aims.empty()) aims_ = moved(mesh.aims, places);
  if (!mesh.normals.empty()) normals_ = moved(mesh.normals, places);
  const std::vector<NumberedCorners> sorted = by_corners(mesh, places);
  heads_.assign(n, none);
  versions_.assign(n, 0);
  uses_.assign(n, 0);
  proper_.assign(n, {});
  next_.assign(std::size_t{3} * m, none);
  marks_.assign(m, 0);
  sample_heads_.assign(m, none);
  triangles_.resize(m);
  sides_.resize(mesh.sides.size());
  planes_.resize(m);
  movable_.resize(m);
  std::vector<std::uint32_t> place(m);
  for (std::uint32_t t = m; t-- > 0;) {  // backwards, so that lists ascend
    triangles_[t] = sorted[t].first;
    place[sorted[t].second] = t;
    if (!sides_.empty()) sides_[t] = mesh.sides[sorted[t].second];
    link(t);
    const LatticeTriangle s = shape(t);
    planes_[t] = exact_normal(s[0], s[1], s[2]);
    movable_[t] = std::ranges::all_of(s, [&](const auto& p) { return box_.contains(p); }) ? 1 : 0;
  }
  for (const std::uint32_t t : mesh.intersecting) intersecting_.push_back(place[t]);
  std::sort(intersecting_.begin(), intersecting_.end());
  take_samples(mesh, place);
  freedom_.resize(n, Freedom::fixed);
  kinds_.resize(n, StarKind::point);
  std::vector<LinkEdge> link;
  for (std::uint32_t v = 0; v < n; ++v) find_freedom(v, link);
}

// By triangle, and then by their places. place: of each triangle of the mesh its number here.
void EditMesh::take_samples(const RefineMesh& mesh, const std::vector<std::uint32_t>& place) {
  std::vector<std::uint32_t> ends(triangles_.size() + 1);
  for (const SurfaceSample& s : mesh.samples) ++ends[place[s.triangle] + 1];
  std::partial_sum(ends.begin(), ends.end(), ends.begin());
  samples_.resize(mesh.samples.size());
  sample_next_.resize(mesh.samples.size());
  for (const SurfaceSample& s : mesh.samples) samples_[ends[place[s.triangle]]++] = s.point;
  for (std::uint32_t t = 0, s = 0; t < triangles_.size(); ++t) {
    std::sort(samples_.begin() + s, samples_.begin() + ends[t]);
    for (; s < ends[t]; ++s) {
      sample_next_[s] = sample_heads_[t];
      sample_heads_[t] = s;
    }
  }
}

TriangleGrid& EditMesh::grid() {
  if (!grid_) {
    grid_.emplace(box_, triangles_.size());
    for (std::uint32_t t = triangles(); t-- > 0;)
      if (alive(t)) grid_->put(t, LatticeBox::around(shape(t)));
  }
  return *grid_;
}

void EditMesh::link(std::uint32_t t) {
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t v = triangles_[t][k], c = 3 * t + k;
    next_[c] = heads_[v];
    heads_[v] = c;
  }
}

void EditMesh::unlink(std::uint32_t t) {
  for (std::uint32_t k = 0; k < 3; ++k) {
    std::uint32_t* at = &heads_[triangles_[t][k]];
    while (*at != 3 * t + k) at = &next_[*at];
    *at = next_[*at];
  }
}

void EditMesh::find_freedom(std::uint32_t v, std::vector<LinkEdge>& link) {
  if (!box_.contains(positions_[v])) return;
  link.clear();
  bool all_inside = true;
  each_around(v, [&](std::uint32_t t) {
    const Corners& c = triangles_[t];
    const std::size_t k = corner_of(c, v);
    link.push_back({c[(k + 1) % 3], c[(k + 2) % 3], sides(t)});
    all_inside = all_inside && movable(t);
  });
  kinds_[v] = kind_of_star(link);
  if (kinds_[v] == StarKind::rim && !samples_box_) kinds_[v] = StarKind::point;
  // Of one surface, where borders end it.
  if (kinds_[v] == StarKind::point && sides_.empty()) return;
  freedom_[v] = all_inside ? Freedom::free : Freedom::anchor;
}

std::int32_t EditMesh::depth(const LatticePoint& p) const {
  std::int32_t depth = std::numeric_limits<std::int32_t>::max();
  for (std::size_t a = 0; a < 3; ++a)
    depth = std::min({depth, p[a] - samples_box_->lo[a], samples_box_->hi[a] - p[a]});
  return depth;
}

void EditMesh::note_left(const Change& change, const Step& step) {
  left_.clear();
  if (step.gone != none) note_left(change, step.gone);
  if (step.leaves_sample && step.moved != none && positions_[step.moved] != step.to)
    note_left(change, step.moved);
}

void EditMesh::note_left(const Change& change, std::uint32_t v) {
  const auto first = static_cast<std::ptrdiff_t>(left_.size());
  for (const std::uint32_t t : change.old) {
    if (!uses(triangles_[t], v)) continue;
    left_.push_back({positions_[v], sides(t)});
    if (kinds_[v] == StarKind::disc) return;
  }
  std::sort(left_.begin() + first, left_.end(),
            [](const Left& a, const Left& b) { return a.sides < b.sides; });
  left_.erase(std::unique(left_.begin() + first, left_.end(),
                          [](const Left& a, const Left& b) { return a.sides == b.sides; }),
              left_.end());
}

double EditMesh::measure(const Change& change, const Step& step, double enough, double most) {
  const double limit = most * most;
  double reach = enough * enough;
  places_.clear();
  note_left(change, step);
  nearest_.clear();
  for (std::size_t i = 0; i < change.shapes.size(); ++i)
    nearest_.add(change.shapes[i], sides(change.old[i]));
  struct Asked {
    LatticePoint place;
    std::uint32_t triangle;  // whose sample it is now; none: a place that is left
  };
  std::array<Asked, lanes> asked;
  const auto answer = [&] {
    const std::size_t count = nearest_.waiting();
    const NearestLanes& nearest = nearest_.answer();
    for (std::size_t i = 0; i < count; ++i) {
      places_.push_back(static_cast<std::uint32_t>(nearest.triangle[i]));
      const auto [place, t] = asked[i];
      const double now = nearest.squared[i];
      if (now > reach && (t == none || now > squared_distance(place, shape(t)))) reach = now;
    }
    return reach <= limit;
  };
  const auto is_near = [&](const Asked& one, const MaterialPair& sides) {
    asked[nearest_.waiting()] = one;
    nearest_.ask(one.place, sides);
    return !nearest_.is_full() || answer();
  };
  for (const Left& left : left_)
    if (!is_near({left.place, none}, left.sides)) return reach;
  for (const std::uint32_t t : change.old)
    for (std::uint32_t s = sample_heads_[t]; s != none; s = sample_next_[s])
      if (!is_near({samples_[s], t}, sides(t))) return reach;
  if (nearest_.waiting() > 0) answer();
  return reach;
}

void EditMesh::apply(const Change& change, const Step& step) {
  keep_proper(change, step);
  std::vector<std::uint32_t>& samples = moved_samples_;
  samples.clear();
  for (const Left& left : left_) {
    samples.push_back(static_cast<std::uint32_t>(samples_.size()));
    samples_.push_back(left.place);
    sample_next_.push_back(none);
  }
  for (const std::uint32_t t : change.old) {
    for (std::uint32_t s = sample_heads_[t]; s != none; s = sample_next_[s]) samples.push_back(s);
    sample_heads_[t] = none;
    unlink(t);
  }
  if (step.gone != none) ++versions_[step.gone];
  if (step.moved != none) {
    positions_[step.moved] = step.to;
    ++versions_[step.moved];
  }
  // Numbers of the old triangles serve for the new ones, of which there are no more.
  for (std::size_t i = 0; i < change.old.size(); ++i) {
    const std::uint32_t t = change.old[i];
    if (!changed_.empty()) changed_[t] = 1;
    if (i >= change.now.size()) {
      triangles_[t] = {none, none, none};
      if (grid_) grid_->remove(t);
      continue;
    }
    triangles_[t] = change.now[i];
    link(t);
    planes_[t] = change.planes[i];
    if (grid_) grid_->put(t, LatticeBox::around(change.shapes[i]));
  }
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const std::uint32_t t = change.old[places_[i]];
    sample_next_[samples[i]] = sample_heads_[t];
    sample_heads_[t] = samples[i];
  }
}

RefineMesh EditMesh::take() && {
  RefineMesh mesh;
  // Where a vertex could be moved that was done, as far as it went.
  for (std::size_t v = 0; v < aims_.size(); ++v)
    if (freedom_[v] == Freedom::free) aims_[v] = positions_[v];
  mesh.checked = true;
  mesh.positions = std::move(positions_);
  mesh.ids = std::move(ids_);
  mesh.aims = std::move(aims_);
  mesh.normals = std::move(normals_);
  auto bad = intersecting_.begin();
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    const bool is_bad = bad != intersecting_.end() && *bad == t;
    if (is_bad) ++bad;
    if (!alive(t)) continue;
    if (is_bad) mesh.intersecting.push_back(static_cast<std::uint32_t>(mesh.triangles.size()));
    Corners c = triangles_[t];
    std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
    for (std::uint32_t s = sample_heads_[t]; s != none; s = sample_next_[s])
      mesh.samples.push_back({samples_[s], static_cast<std::uint32_t>(mesh.triangles.size())});
    mesh.triangles.push_back(c);
    if (!sides_.empty()) mesh.sides.push_back(sides_[t]);
  }
  return mesh;
}

}  // namespace voxweld
