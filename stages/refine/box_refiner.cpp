#include "stages/refine/box_refiner.h"

#include <algorithm>

#include "stages/refine/refine_cube.h"

namespace voxweld {
namespace {

constexpr std::int32_t least_side = 64;  // of a part, in lattice steps

// Not cut in the middle, where the other pass has its borders: what no part of the one pass may change
// lies inside of one of the other.
std::array<LatticeBox, 8> octants(const LatticeBox& box) {
  std::array<LatticeBox, 8> parts;
  for (std::size_t i = 0; i < 8; ++i) {
    parts[i] = box;
    for (std::size_t a = 0; a < 3; ++a) {
      const std::int32_t middle = box.lo[a] + (box.hi[a] - box.lo[a]) / 8 * 3;
      if ((i >> a & 1) == 0)
        parts[i].hi[a] = middle;
      else
        parts[i].lo[a] = middle + 1;
    }
  }
  return parts;
}

}  // namespace

bool lies_in(const RefineMesh& mesh, std::size_t triangle, const LatticeBox& box) {
  return std::ranges::all_of(mesh.triangles[triangle],
                             [&](std::uint32_t v) { return box.contains(mesh.positions[v]); });
}

void each_part(const RefineMesh& mesh, const Room& room, const TriangleNumbers& meeting,
               const std::function<void(const LatticeBox&, const TriangleNumbers&)>& f,
               const std::function<void(std::uint32_t)>& left) {
  const auto& [box, whole] = room;
  if (meeting.size() <= most_part_triangles || whole.hi[0] - whole.lo[0] < 2 * least_side)
    return f(box, meeting);
  std::vector<LatticeBox> parts;
  for (const LatticeBox& octant : octants(whole)) {
    if (!octant.meets(box)) continue;
    const LatticeBox& part = parts.emplace_back(octant.common(box));
    TriangleNumbers inside;
    for (const std::uint32_t t : meeting)
      if (mesh.box(t).meets(part)) inside.push_back(t);
    each_part(mesh, {part, octant}, inside, f, left);
  }
  for (const std::uint32_t t : meeting)
    if (lies_in(mesh, t, box) &&
        std::ranges::none_of(parts, [&](const auto& part) { return lies_in(mesh, t, part); }))
      left(t);
}

void BoxRefiner::refine(const Work& work) {
  const auto as_it_is = [&](std::uint32_t t) {
    add_done(0, t, std::binary_search(work.bad.begin(), work.bad.end(), t));
  };
  each_part(
      mesh_, work.room, work.meeting,
      [&](const LatticeBox& part, const TriangleNumbers& inside) { refine_part(part, inside); },
      as_it_is);
  for (const std::uint32_t t : work.others) as_it_is(t);
  put_out();
}

void BoxRefiner::keep(const TriangleNumbers& triangles, const TriangleNumbers& bad) {
  for (const std::uint32_t t : triangles)
    add_done(0, t, std::binary_search(bad.begin(), bad.end(), t));
  put_out();
}

RefineMesh BoxRefiner::take() {
  RefineMesh result = out_.take();
  result.checked = parameters_.intersections != IntersectionRule::ignore;
  return result;
}

void BoxRefiner::add_done(std::size_t mesh, std::uint32_t triangle, bool intersects) {
  Done done{static_cast<std::uint32_t>(mesh) & 0x7fffffffu, intersects ? 1u : 0u, triangle, {}};
  const RefineMesh& from = mesh_of(done);
  done.first = from.ids[from.triangles[triangle][0]];
  done_.push_back(done);
}

// Whether it is known that nothing will be done.
bool BoxRefiner::stays(const TriangleNumbers& triangles) const {
  if (parameters_.mode == RefineMode::collapse) return false;
  if (parameters_.intersections == IntersectionRule::ignore) return true;
  return mesh_.checked &&
         std::ranges::none_of(triangles, [&](std::uint32_t t) { return mesh_.intersects(t); });
}

// All that lies in a box that is not cut up.
void BoxRefiner::refine_part(const LatticeBox& box, const TriangleNumbers& triangles) {
  if (stays(triangles)) {
    for (const std::uint32_t t : triangles)
      if (lies_in(mesh_, t, box)) add_done(0, t, false);
    return;
  }
  refined_.push_back(std::make_unique<RefineMesh>(extract_.of(triangles)));
  RefineMesh& part = *refined_.back();
  refine_cube(part, box, parameters_, counts_);
  auto bad = part.intersecting.begin();
  for (std::uint32_t t = 0; t < part.triangles.size(); ++t) {
    const bool intersects = bad != part.intersecting.end() && *bad == t;
    if (intersects) ++bad;
    if (lies_in(part, t, box)) add_done(refined_.size(), t, intersects);
  }
}

void BoxRefiner::put_out() {
  std::sort(done_.begin(), done_.end(), [&](const Done& a, const Done& b) {
    if (a.first != b.first) return a.first < b.first;
    return mesh_of(a).ids_of(a.triangle) < mesh_of(b).ids_of(b.triangle);
  });
  std::vector<MeshGather::Part> parts;
  parts.reserve(refined_.size());
  for (const auto& mesh : refined_) parts.emplace_back(*mesh);
  for (const Done& done : done_) {
    MeshGather::Part& part = done.mesh == 0 ? as_it_was_ : parts[done.mesh - 1];
    const RefineMesh& mesh = part.mesh();
    out_.add_triangle(part, done.triangle, done.intersects != 0);
    each_sample_distance(mesh, done.triangle, [&](double d) { counts_.add_distance(d); });
  }
  done_.clear();
  refined_.clear();
}

}  // namespace voxweld
