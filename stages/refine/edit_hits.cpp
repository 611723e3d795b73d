#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>

#include "stages/refine/box_pairs.h"
#include "stages/refine/edit_mesh.h"
#include "stages/refine/plane_tests.h"

// Which triangles intersect, behind tests that spare nearly all of them an exact look.
//
// Triangles that share a vertex: where all around it, seen along one direction, run the same way and once
// around, they lie beside each other as their shadows do (umbrella.h). That is decided by signs of integers.

namespace voxweld {
namespace {

bool share_a_vertex(const Corners& a, const Corners& b) {
  for (const std::uint32_t v : a)
    if (uses(b, v)) return true;
  return false;
}

// Of triangles that share a vertex. Where different vertices lie at one place these seem to share more
// than they do, as places are.
bool intersect(const Corners& a, const LatticeTriangle& shape_a, const Index3& normal_a,
               const Corners& b, const LatticeTriangle& shape_b, const Index3& normal_b) {
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      if (a[i] != b[j] && same_place(shape_a[i], shape_b[j])) return true;
  return intersect_by_planes(shape_a, normal_a, shape_b, normal_b);
}

void make_ascending(std::vector<std::uint32_t>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

}  // namespace

// Of one umbrella.
bool EditMesh::ribs_intersect(std::size_t i, std::size_t j) const {
  const Rib &a = umbrella_[i], &b = umbrella_[j];
  return intersect(a.corners, a.shape(), *a.normal, b.corners, b.shape(), *b.normal);
}

// Whether triangle t and `other`, which share no vertex, have nothing in common, not even a place.
bool EditMesh::apart(std::uint32_t t, const LatticeTriangle& other, const Index3& normal) const {
  return lie_apart(shape(t), planes_[t], other, normal);
}

// The triangles around v as they will be; where there is no change, as they are.
void EditMesh::gather_umbrella(std::uint32_t v, const Change* change) {
  umbrella_.clear();
  if (change != nullptr)
    for (std::uint64_t left = uses_[v]; left != 0; left &= left - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(left));
      const LatticeTriangle& s = change->shapes[i];
      const Corners& c = change->now[i];
      const std::size_t k = corner_of(c, v), next = (k + 1) % 3, last = (k + 2) % 3;
      umbrella_.push_back(
          {&s[k], &s[next], &s[last], &change->planes[i], none, {v, c[next], c[last]}});
    }
  each_around(v, [&](std::uint32_t t) {
    if (change != nullptr && marks_[t] == mark_) return;
    const Corners& c = triangles_[t];
    const std::size_t k = corner_of(c, v);
    const std::uint32_t next = c[(k + 1) % 3], last = c[(k + 2) % 3];
    umbrella_.push_back(
        {&positions_[v], &positions_[next], &positions_[last], &planes_[t], t, {v, next, last}});
  });
}

// How the umbrella that was gathered is proper; nothing where it is not, as far as that is looked into.
Along EditMesh::proper_along(std::uint32_t v) const {
  // Where several sheets meet, their shadows may lie on each other.
  if (kinds_[v] != StarKind::disc) return {};
  Vec3 sum;
  for (const Rib& rib : umbrella_) sum = sum + as_vec3(*rib.normal);
  // Most are so along the axis along which they are largest together, which is quickest to see.
  const int axis = longest_axis(sum);
  if (is_proper_along_axis(axis, sum[axis] > 0)) {
    Along along{};
    along[static_cast<std::size_t>(axis)] = sum[axis] > 0 ? 1 : -1;
    return along;
  }
  const Along along = direction_of(sum);
  ShadowTurns turns(along);
  for (const Rib& rib : umbrella_)
    if (!turns.add(*rib.at, *rib.next, *rib.last, *rib.normal)) return {};
  return turns.once() ? along : Along{};
}

bool EditMesh::is_proper_along_axis(int axis, bool up) const {
  const auto side = static_cast<std::size_t>((axis + 1) % 3);
  std::size_t changes = 0;
  for (const Rib& rib : umbrella_) {
    const std::int64_t along = (*rib.normal)[axis];
    if (up ? along <= 0 : along >= 0) return false;
    const std::int32_t at = (*rib.at)[side];
    changes += ((*rib.next)[side] < at) != ((*rib.last)[side] < at) ? 1 : 0;
  }
  return changes == 2;
}

// Where one or two triangles come in the place of some, and run the same way, they all still run once
// around: two are less than a whole turn, and there are only whole turns.
bool EditMesh::stays_proper(std::uint32_t v, const Change& change) {
  if (std::popcount(uses_[v]) > 2 || kinds_[v] != StarKind::disc) return false;
  if (proper_[v] == Along{}) {
    gather_umbrella(v, nullptr);
    proper_[v] = proper_along(v);
    if (proper_[v] == Along{}) return false;
  }
  for (std::uint64_t left = uses_[v]; left != 0; left &= left - 1)
    if (!runs_along(change.planes[static_cast<std::size_t>(std::countr_zero(left))], proper_[v]))
      return false;
  return true;
}

// What is still known of vertices once the change is made. All but the one that moves get two new
// triangles at most, as edges of discs have two.
void EditMesh::keep_proper(const Change& change, const Step& step) {
  for (std::size_t i = 0; i < change.now.size(); ++i)
    for (const std::uint32_t v : change.now[i])
      if (!runs_along(change.planes[i], proper_[v])) proper_[v] = {};
  if (step.moved != none) proper_[step.moved] = {};
}

void EditMesh::mark_old(const Change& change) {
  ++mark_;
  for (const std::uint32_t t : change.old) marks_[t] = mark_;
}

// What f says while the uses of the change's vertices are known.
template <class F>
bool EditMesh::with_uses(const Change& change, F&& f) {
  mark_old(change);
  for (std::size_t i = 0; i < change.now.size(); ++i)
    for (const std::uint32_t v : change.now[i]) {
      if (uses_[v] == 0) used_.push_back(v);
      uses_[v] |= std::uint64_t{1} << i;
    }
  const bool result = f();
  for (const std::uint32_t v : used_) uses_[v] = 0;
  used_.clear();
  return result;
}

bool EditMesh::clean(const Change& change) {
  return with_uses(change,
                   [&] { return umbrellas_are_clean(change) && others_stay_apart(change); });
}

bool EditMesh::clean_around(const Change& change) {
  return with_uses(change, [&] { return umbrellas_are_clean(change); });
}

// Of those that share a vertex with a new one.
bool EditMesh::umbrellas_are_clean(const Change& change) {
  for (const std::uint32_t v : used_) {
    if (stays_proper(v, change)) continue;
    gather_umbrella(v, &change);
    if (proper_along(v) != Along{}) continue;
    for (std::size_t i = 0; i < umbrella_.size() && umbrella_[i].triangle == none; ++i)
      for (std::size_t j = i + 1; j < umbrella_.size(); ++j)
        if (ribs_intersect(i, j)) return false;
  }
  return true;
}

// Those that share none.
bool EditMesh::others_stay_apart(const Change& change) {
  BoxQueries boxes = grid().queries();
  for (const LatticeTriangle& t : change.shapes) boxes.add(LatticeBox::around(t));
  return grid().none_near(boxes, [&](std::uint32_t t, std::uint64_t left) {
    if (marks_[t] == mark_) return false;
    for (const std::uint32_t v : triangles_[t]) left &= ~uses_[v];
    for (; left != 0; left &= left - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(left));
      if (!apart(t, change.shapes[i], change.planes[i])) return true;
    }
    return false;
  });
}

// Of triangles of the mesh.
bool EditMesh::hit(std::uint32_t t, const Corners& corners, const LatticeTriangle& own,
                   const Index3& normal) const {
  if (!share_a_vertex(corners, triangles_[t])) return !apart(t, own, normal);
  return intersect(corners, own, normal, triangles_[t], shape(t), planes_[t]);
}

std::size_t EditMesh::hits(const Change& change, std::size_t most,
                           std::span<const std::uint32_t> likely) {
  mark_old(change);
  BoxQueries boxes = grid().queries();
  for (const LatticeTriangle& t : change.shapes) boxes.add(LatticeBox::around(t));
  std::size_t count = 0;
  const auto add = [&](std::uint32_t t, std::uint64_t near) {
    for (; near != 0; near &= near - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(near));
      count += hit(t, change.now[i], change.shapes[i], change.planes[i]) ? 1 : 0;
    }
    return count >= most;
  };
  for (const std::uint32_t t : likely) {
    marks_[t] = mark_;
    if (add(t, boxes.meeting(grid().packed(t, LatticeBox::around(shape(t)))))) return count;
  }
  for (std::size_t i = 0; i < change.shapes.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      count += intersect(change.now[i], change.shapes[i], change.planes[i], change.now[j],
                         change.shapes[j], change.planes[j])
                   ? 1
                   : 0;
  if (count >= most) return count;
  grid().none_near(boxes, [&](std::uint32_t t, std::uint64_t near) {
    return marks_[t] != mark_ && add(t, near);
  });
  return count;
}

std::vector<std::uint32_t> EditMesh::find_intersecting() {
  std::vector<std::uint32_t> bad;
  const auto add = [&](std::uint32_t a, std::uint32_t b) {
    bad.push_back(a);
    bad.push_back(b);
  };
  for (std::uint32_t v = 0; v < vertices(); ++v) {
    if (!box_.contains(positions_[v])) continue;
    gather_umbrella(v, nullptr);
    if (umbrella_.size() < 2) continue;
    proper_[v] = proper_along(v);
    if (proper_[v] != Along{}) continue;
    for (std::size_t i = 0; i < umbrella_.size(); ++i)
      for (std::size_t j = i + 1; j < umbrella_.size(); ++j) {
        const std::uint32_t a = umbrella_[i].triangle, b = umbrella_[j].triangle;
        if ((movable(a) || movable(b)) && ribs_intersect(i, j)) add(a, b);
      }
  }
  add_intersecting_apart([&](std::uint32_t t) { return movable(t); }, bad);
  make_ascending(bad);
  return bad;
}

// Of pairs that share no vertex, of which takes() holds for one.
template <class Takes>
void EditMesh::add_intersecting_apart(Takes&& takes, std::vector<std::uint32_t>& bad) const {
  std::vector<std::uint32_t> numbers;
  std::vector<LatticeBox> boxes;
  numbers.reserve(triangles_.size());
  boxes.reserve(triangles_.size());
  for (std::uint32_t t = 0; t < triangles(); ++t) {
    if (!alive(t)) continue;
    numbers.push_back(t);
    boxes.push_back(LatticeBox::around(shape(t)));
  }
  BoxPairs(boxes).each([&](std::uint32_t a, std::uint32_t b) {
    const std::uint32_t t = numbers[a], other = numbers[b];
    if ((!takes(t) && !takes(other)) || share_a_vertex(triangles_[t], triangles_[other]) ||
        apart(other, shape(t), planes_[t]))
      return;
    bad.push_back(t);
    bad.push_back(other);
  });
}

void EditMesh::begin_changes() {
  changed_.assign(triangles_.size(), 0);
  grid_.reset();
}

std::vector<std::uint32_t> EditMesh::end_changes() {
  std::vector<std::uint32_t> bad;
  add_intersecting_apart([&](std::uint32_t t) { return changed_[t] != 0; }, bad);
  make_ascending(bad);
  changed_.clear();
  return bad;
}

void EditMesh::add_intersecting(std::span<const std::uint32_t> more) {
  if (more.empty()) return;
  intersecting_.insert(intersecting_.end(), more.begin(), more.end());
  make_ascending(intersecting_);
  recheck_intersecting();
}

void EditMesh::complete_intersecting() {
  std::vector<std::uint32_t> all;
  for (const std::uint32_t t : intersecting_) {
    if (!alive(t)) continue;
    bool any = false;
    each_hit(t, [&](std::uint32_t other) {
      any = true;
      if (movable(t) || movable(other)) all.push_back(other);
    });
    if (any) all.push_back(t);
  }
  make_ascending(all);
  intersecting_ = std::move(all);
}

std::size_t EditMesh::count_pairs() {
  std::size_t pairs = 0;
  for (const std::uint32_t t : intersecting_) {
    if (!alive(t)) continue;
    each_hit(t, [&](std::uint32_t other) {
      if (!movable(t) && !movable(other)) return;
      const bool listed = std::binary_search(intersecting_.begin(), intersecting_.end(), other);
      pairs += !listed || other > t ? 1 : 0;
    });
  }
  return pairs;
}

}  // namespace voxweld
