#include "stages/refine/mend_box.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>

#include "stages/exact/triangle_pair.h"
#include "stages/refine/box_refiner.h"
#include "stages/refine/fixed_pairs.h"
#include "stages/refine/untie.h"

namespace voxweld {
namespace {

constexpr std::size_t most_trials = 8;        // places in a box
constexpr std::size_t most_around = 1 << 12;  // triangles around a place

class BoxMender {
 public:
  BoxMender(const RefineMesh& mesh, const LatticeBox& box, const RefineParameters& parameters,
            RefineCounts& counts)
      : mesh_(mesh), box_(box), parameters_(parameters), counts_(counts) {}

  RefineMesh run() {
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
      if (!lies_in(mesh_, t, box_)) fixed_.push_back(t);
    remove_distances(mesh_, box_);
    repair();
    if (parameters_.mode == RefineMode::mend) untie();
    return std::move(mended_);
  }

 private:
  void remove_distances(const RefineMesh& mesh, const LatticeBox& box) {
    SampleReader samples(mesh);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
      if (lies_in(mesh, t, box))
        each_sample_distance(mesh, samples, t, [&](double d) { counts_.remove_distance(d); });
  }
  void repair();
  void untie();
  bool still_intersects(std::uint32_t t) const;
  LatticeBox room_around(std::uint32_t t, double times) const;
  bool untie_in(const LatticeBox& room, std::set<Knot>& tied);

  const RefineMesh& mesh_;
  const LatticeBox& box_;
  const RefineParameters& parameters_;
  RefineCounts& counts_;
  TriangleNumbers fixed_;  // of mesh_, that do not lie in the box
  RefineMesh mended_;      // what lies there, as it is now
};

void BoxMender::repair() {
  TriangleNumbers all(mesh_.triangles.size());
  std::iota(all.begin(), all.end(), 0U);
  std::vector<FixedTriangle> fixed;
  for (const std::uint32_t t : fixed_) fixed.push_back({t, false, false});
  const Room room{box_, box_};
  each_part(
      mesh_, room, all, [](const auto&, const auto&) {},
      [&](std::uint32_t t) {
        fixed.push_back({t, true, true});
      });
  const FixedPairs found = find_fixed_pairs(mesh_, fixed);
  ++counts_.cubes;
  counts_.pairs_before += found.pairs;
  counts_.pairs_left += found.pairs;
  BoxRefiner refiner(mesh_, parameters_, counts_);
  refiner.refine({room, all, {}, found.intersecting});
  mended_ = refiner.take();
}

// Of mended_: what it did intersect may have been untied with something else.
bool BoxMender::still_intersects(std::uint32_t t) const {
  const LatticeBox box = mended_.box(t);
  const LatticeTriangle shape = mended_.shape(t);
  for (std::uint32_t other = 0; other < mended_.triangles.size(); ++other)
    if (other != t && mended_.box(other).meets(box) &&
        intersect_beyond_shared(shape, mended_.shape(other)))
      return true;
  return std::ranges::any_of(fixed_, [&](std::uint32_t other) {
    return mesh_.box(other).meets(box) && intersect_beyond_shared(shape, mesh_.shape(other));
  });
}

// Places that are left, one after the other.
void BoxMender::untie() {
  std::set<std::array<VertexId, 3>> tried;
  // Vertices around a place may have triangles that leave the first room, and stay where they are there.
  struct Trial {
    double times;
    std::set<Knot> tied{};
  };
  std::array<Trial, 3> trials{{{0.5}, {1.0}, {4.0}}};
  while (tried.size() < most_trials) {
    const auto next = std::ranges::find_if(
        mended_.intersecting, [&](std::uint32_t t) { return !tried.contains(mended_.ids_of(t)); });
    if (next == mended_.intersecting.end()) return;
    const std::uint32_t t = *next;
    tried.insert(mended_.ids_of(t));
    for (Trial& trial : trials) {
      const LatticeBox room = room_around(t, trial.times);
      if (!untie_in(room, trial.tied)) continue;
      std::erase_if(mended_.intersecting, [&](std::uint32_t left) {
        return mended_.box(left).meets(room) && !still_intersects(left);
      });
      break;
    }
  }
}

// A box around the triangle with some room, or so many times as much, which lies in the box at hand.
LatticeBox BoxMender::room_around(std::uint32_t t, double times) const {
  LatticeBox room = mended_.box(t);
  std::int32_t length = 0;
  for (std::size_t a = 0; a < 3; ++a) length = std::max(length, room.hi[a] - room.lo[a]);
  length = static_cast<std::int32_t>(times * (length + 4 * parameters_.reach));
  for (std::size_t a = 0; a < 3; ++a) {
    room.lo[a] = std::max(box_.lo[a], room.lo[a] - length);
    room.hi[a] = std::min(box_.hi[a], room.hi[a] + length);
  }
  return room;
}

// Whether fewer pairs are left.
bool BoxMender::untie_in(const LatticeBox& room, std::set<Knot>& tied) {
  MeshGather gather;
  gather.add(mended_, [&](std::size_t t) { return mended_.box(t).meets(room); });
  for (const std::uint32_t t : fixed_)
    if (mesh_.box(t).meets(room)) gather.add_triangle(mesh_, t, mesh_.intersects(t));
  const RefineMesh near = gather.take();
  if (near.triangles.size() > most_around) return false;
  EditMesh edit(near, room, parameters_.samples);
  const std::size_t before = edit.count_pairs();
  RefineCounts untied;
  untie_intersections(edit, parameters_, tied, untied);
  const std::size_t after = edit.count_pairs();
  if (after >= before) return false;
  counts_.add(untied);
  counts_.pairs_left -= before - after;
  remove_distances(near, room);
  const RefineMesh result = std::move(edit).take();
  const auto has_changed = [&](const RefineMesh& mesh, std::size_t t) {
    return lies_in(mesh, t, room);
  };
  gather.add(mended_, [&](std::size_t t) { return !has_changed(mended_, t); });
  gather.add(result, [&](std::size_t t) { return has_changed(result, t); });
  SampleReader samples(result);
  for (std::uint32_t t = 0; t < result.triangles.size(); ++t)
    if (has_changed(result, t))
      each_sample_distance(result, samples, t, [&](double d) { counts_.add_distance(d); });
  mended_ = gather.take();
  return true;
}

}  // namespace

RefineMesh mend_box(const RefineMesh& mesh, const LatticeBox& box,
                    const RefineParameters& parameters, RefineCounts& counts) {
  return BoxMender(mesh, box, parameters, counts).run();
}

}  // namespace voxweld
