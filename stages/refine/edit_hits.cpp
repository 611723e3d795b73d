#include <algorithm>

#include "stages/exact/orientation.h"
#include "stages/refine/edit_mesh.h"

// Which triangles intersect, behind tests that spare nearly all of them an exact look.
//
// Triangles that share a vertex: where all around it, seen along one axis, run the same way and once
// around, they lie beside each other as their shadows do. That is decided by signs of integers.
// Others: mostly one has all corners on one side of the other's plane.

namespace voxweld {
namespace {

bool share_a_vertex(const Corners& a, const Corners& b) {
  for (const std::uint32_t v : a)
    if (uses(b, v)) return true;
  return false;
}

bool share_a_place(const LatticeTriangle& a, const LatticeTriangle& b) {
  for (const LatticePoint& p : a)
    if (p == b[0] || p == b[1] || p == b[2]) return true;
  return false;
}

// All of b strictly on one side of a's plane.
bool on_one_side(const LatticeTriangle& a, const Index3& normal, const LatticeTriangle& b) {
  const int side = sign_of_dot(normal, lattice_vector(a[0], b[0]));
  return side != 0 && sign_of_dot(normal, lattice_vector(a[0], b[1])) == side &&
         sign_of_dot(normal, lattice_vector(a[0], b[2])) == side;
}

}  // namespace

// Whether triangle t and `other`, which share no vertex, have nothing in common, not even a place.
bool EditMesh::apart(std::uint32_t t, const LatticeTriangle& other, const Index3& normal) const {
  const LatticeTriangle own = shape(t);
  if (on_one_side(other, normal, own) || on_one_side(own, planes_[t], other)) return true;
  return !share_a_place(own, other) && !intersect_beyond_shared(own, other);
}

// The triangles around v as they will be; where there is no change, as they are.
void EditMesh::gather_umbrella(std::uint32_t v, const Change* change) {
  umbrella_.clear();
  const auto add = [&](const Corners& c, const LatticeTriangle& s, const Index3& normal,
                       std::uint32_t t) {
    const std::size_t k = corner_of(c, v);
    umbrella_.push_back({{s[k], s[(k + 1) % 3], s[(k + 2) % 3]}, normal, t});
  };
  if (change != nullptr)
    for (std::size_t i = 0; i < change->now.size(); ++i) {
      const Corners& c = change->now[i];
      if (uses(c, v)) add(c, change->shapes[i], change->planes[i], none);
    }
  each_around(v, [&](std::uint32_t t) {
    if (change == nullptr || marks_[t] != mark_) add(triangles_[t], shape(t), planes_[t], t);
  });
}

bool EditMesh::is_proper_umbrella(std::uint32_t v) const {
  // Where several sheets meet, their shadows may lie on each other.
  if (kinds_[v] != StarKind::disc) return false;
  // Along the axis in which they are largest together.
  std::array<double, 3> sums{};
  for (const Rib& rib : umbrella_)
    for (int a = 0; a < 3; ++a)
      sums[static_cast<std::size_t>(a)] += static_cast<double>(rib.normal[a]);
  std::size_t axis = 0;
  for (std::size_t a = 1; a < 3; ++a)
    if (std::abs(sums[a]) > std::abs(sums[axis])) axis = a;
  const std::size_t up = (axis + 1) % 3;
  const bool positive = sums[axis] > 0;
  std::size_t changes = 0;
  for (const Rib& rib : umbrella_) {
    const std::int64_t n = rib.normal[static_cast<int>(axis)];
    if (n == 0 || (n > 0) != positive) return false;
    const std::int32_t y = rib.shape[0][up];
    changes += (rib.shape[1][up] < y) != (rib.shape[2][up] < y) ? 1 : 0;
  }
  return changes == 2;
}

void EditMesh::mark_old(const Change& change) {
  ++mark_;
  for (const std::uint32_t t : change.old) marks_[t] = mark_;
}

bool EditMesh::clean(const Change& change) {
  mark_old(change);
  LatticeBox all = LatticeBox::around(change.shapes.front());
  for (const LatticeTriangle& t : change.shapes) all.extend(LatticeBox::around(t));
  near_.clear();
  grid_.each_near(all, [&](std::uint32_t t) {
    const LatticeBox& box = boxes_[t];
    if (box.meets(all) && alive(t) && marks_[t] != mark_) near_.push_back({box, t});
  });
  corners_near_.clear();
  for (const Corners& c : change.now) corners_near_.insert(corners_near_.end(), c.begin(), c.end());
  std::sort(corners_near_.begin(), corners_near_.end());
  corners_near_.erase(std::unique(corners_near_.begin(), corners_near_.end()), corners_near_.end());
  for (const std::uint32_t v : corners_near_) {
    gather_umbrella(v, &change);
    if (is_proper_umbrella(v)) continue;
    for (std::size_t i = 0; i < umbrella_.size() && umbrella_[i].triangle == none; ++i)
      for (std::size_t j = i + 1; j < umbrella_.size(); ++j)
        if (intersect_beyond_shared(umbrella_[i].shape, umbrella_[j].shape)) return false;
  }
  for (std::size_t i = 0; i < change.now.size(); ++i) {
    const LatticeTriangle& own = change.shapes[i];
    const LatticeBox box = LatticeBox::around(own);
    const Index3& normal = change.planes[i];
    for (const Near& near : near_)
      if (near.box.meets(box) && !share_a_vertex(change.now[i], triangles_[near.triangle]) &&
          !apart(near.triangle, own, normal))
        return false;
  }
  return true;
}

// Of triangles of the mesh.
bool EditMesh::hit(std::uint32_t t, const Corners& corners, const LatticeTriangle& own,
                   const Index3& normal) const {
  return share_a_vertex(corners, triangles_[t]) ? intersect_beyond_shared(own, shape(t))
                                                : !apart(t, own, normal);
}

std::size_t EditMesh::hits(const Change& change, std::size_t most) {
  mark_old(change);
  std::size_t count = 0;
  for (std::size_t i = 0; i < change.shapes.size() && count < most; ++i) {
    const LatticeTriangle& own = change.shapes[i];
    for (std::size_t j = 0; j < i; ++j)
      count += intersect_beyond_shared(own, change.shapes[j]) ? 1 : 0;
    const LatticeBox box = LatticeBox::around(own);
    const Index3& normal = change.planes[i];
    grid_.each_near(box, [&](std::uint32_t t) {
      if (count < most && boxes_[t].meets(box) && alive(t) && marks_[t] != mark_)
        count += hit(t, change.now[i], own, normal) ? 1 : 0;
    });
  }
  return count;
}

std::size_t EditMesh::hits(std::span<const std::uint32_t> some) {
  ++mark_;
  const std::uint32_t mark = mark_;
  std::size_t count = 0;
  for (const std::uint32_t t : some) {
    each_hit(t, [&](std::uint32_t other) { count += marks_[other] != mark ? 1 : 0; });
    marks_[t] = mark;
  }
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
    if (umbrella_.size() < 2 || is_proper_umbrella(v)) continue;
    for (std::size_t i = 0; i < umbrella_.size(); ++i)
      for (std::size_t j = i + 1; j < umbrella_.size(); ++j) {
        const std::uint32_t a = umbrella_[i].triangle, b = umbrella_[j].triangle;
        if ((movable(a) || movable(b)) &&
            intersect_beyond_shared(umbrella_[i].shape, umbrella_[j].shape))
          add(a, b);
      }
  }
  for (std::uint32_t t = 0; t < triangles(); ++t) {
    if (!movable(t)) continue;
    const LatticeTriangle own = shape(t);
    const LatticeBox box = boxes_[t];
    const Index3& normal = planes_[t];
    grid_.each_near(box, [&](std::uint32_t other) {
      if ((other > t || !movable(other)) && boxes_[other].meets(box) &&
          !share_a_vertex(triangles_[t], triangles_[other]) && !apart(other, own, normal))
        add(t, other);
    });
  }
  std::sort(bad.begin(), bad.end());
  bad.erase(std::unique(bad.begin(), bad.end()), bad.end());
  return bad;
}

std::size_t EditMesh::count_pairs() const {
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
