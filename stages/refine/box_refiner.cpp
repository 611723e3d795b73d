#include "stages/refine/box_refiner.h"

#include <algorithm>

#include "stages/refine/refine_cube.h"
#include "storage/support/parallel.h"

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

// Not worth to be cut.
bool is_small(const LatticeBox& box) {
  for (std::size_t a = 0; a < 3; ++a)
    if (box.hi[a] - box.lo[a] >= 2 * least_side) return false;
  return true;
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
  if (meeting.size() <= most_part_triangles || is_small(whole)) return f(box, meeting);
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
  put_out(work_on(work, std::span(&extract_, 1)));
}

BoxRefiner::Outcome BoxRefiner::kept(const TriangleNumbers& triangles,
                                     const TriangleNumbers& bad) const {
  Outcome outcome(mesh_);
  for (const std::uint32_t t : triangles) outcome.keep(t, bad);
  outcome.finish(parameters_.counts_distances);
  return outcome;
}

RefineMesh BoxRefiner::take() {
  RefineMesh result = out_.take();
  result.checked = parameters_.intersections != IntersectionRule::ignore;
  return result;
}

// A box, or what it is cut up into.
struct BoxRefiner::Part {
  LatticeBox box;
  TriangleNumbers inside;            // that meet it
  std::unique_ptr<RefineMesh> mesh;  // refined; null: they stay as they are
  RefineCounts counts = {};
};

void BoxRefiner::work_on_part(Part& part, Extract& extract) const {
  if (stays(part.inside)) return;
  part.mesh = std::make_unique<RefineMesh>(extract.of(part.inside));
  refine_cube(*part.mesh, part.box, parameters_, part.counts);
}

BoxRefiner::Outcome BoxRefiner::work_on(const Work& work, std::span<Extract> extracts) const {
  Outcome outcome(mesh_);
  std::vector<Part> parts;
  each_part(
      mesh_, work.room, work.meeting,
      [&](const LatticeBox& box, const TriangleNumbers& inside) {
        parts.push_back({box, inside, nullptr});
      },
      [&](std::uint32_t t) { outcome.keep(t, work.bad); });
  for_each_in_order(
      {parts.size(), [&](std::size_t i) { return parts[i].inside.size(); },
       [&](std::size_t i, std::size_t slot) { work_on_part(parts[i], extracts[slot]); },
       [&](std::size_t i, std::size_t) { outcome.add(std::move(parts[i])); }},
      extracts.size(), parameters_.at_once);
  for (const std::uint32_t t : work.others) outcome.keep(t, work.bad);
  outcome.finish(parameters_.counts_distances);
  return outcome;
}

// Whether it is known that nothing will be done.
bool BoxRefiner::stays(const TriangleNumbers& triangles) const {
  if (parameters_.mode == RefineMode::collapse) return false;
  if (parameters_.intersections == IntersectionRule::ignore) return true;
  return mesh_.checked &&
         std::ranges::none_of(triangles, [&](std::uint32_t t) { return mesh_.intersects(t); });
}

void BoxRefiner::put_out(const Outcome& outcome) {
  counts_.add(outcome.counts_);
  std::vector<MeshGather::Part> parts;
  parts.reserve(outcome.refined_.size());
  for (const auto& mesh : outcome.refined_) parts.emplace_back(*mesh);
  for (const Outcome::Done& done : outcome.done_)
    out_.add_triangle(done.mesh == 0 ? as_it_was_ : parts[done.mesh - 1], done.triangle,
                      done.intersects != 0);
}

void BoxRefiner::Outcome::add(std::size_t mesh, std::uint32_t triangle, bool intersects) {
  Done done{static_cast<std::uint32_t>(mesh) & 0x7fffffffu, intersects ? 1u : 0u, triangle, {}};
  const RefineMesh& from = mesh_of(done);
  done.first = from.ids[from.triangles[triangle][0]];
  done_.push_back(done);
}

void BoxRefiner::Outcome::add(Part&& part) {
  counts_.add(part.counts);
  if (part.mesh != nullptr) return add_refined(std::move(part.mesh), part.box);
  for (const std::uint32_t t : part.inside)
    if (lies_in(*mesh_, t, part.box)) add(0, t, false);
}

void BoxRefiner::Outcome::add_refined(std::unique_ptr<RefineMesh> part, const LatticeBox& box) {
  const RefineMesh& mesh = *refined_.emplace_back(std::move(part));
  auto bad = mesh.intersecting.begin();
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const bool intersects = bad != mesh.intersecting.end() && *bad == t;
    if (intersects) ++bad;
    if (lies_in(mesh, t, box)) add(refined_.size(), t, intersects);
  }
}

void BoxRefiner::Outcome::finish(bool counts_distances) {
  std::sort(done_.begin(), done_.end(), [&](const Done& a, const Done& b) {
    if (a.first != b.first) return a.first < b.first;
    return mesh_of(a).ids_of(a.triangle) < mesh_of(b).ids_of(b.triangle);
  });
  if (!counts_distances) return;
  std::vector<SampleReader> samples{SampleReader(*mesh_)};
  for (const auto& mesh : refined_) samples.emplace_back(*mesh);
  for (const Done& done : done_)
    each_sample_distance(mesh_of(done), samples[done.mesh], done.triangle,
                         [&](double d) { counts_.add_distance(d); });
}

}  // namespace voxweld
