#include "pipeline/refine/mend_plan.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "pipeline/executor/probe.h"
#include "stages/exact/box_tree.h"

namespace voxweld {
namespace {

// Of some places, of one label, those that lie in none of the boxes.
std::vector<IntersectionRecord> those_beside(const std::vector<IntersectionRecord>& places,
                                             const std::vector<LatticeBox>& boxes) {
  const BoxTree tree(boxes);
  std::vector<IntersectionRecord> beside;
  std::ranges::copy_if(places, std::back_inserter(beside), [&](const IntersectionRecord& place) {
    return !tree.any_meeting(place.box, [&](std::uint32_t i) {
      return boxes[i].contains(place.box.lo) && boxes[i].contains(place.box.hi);
    });
  });
  std::ranges::sort(beside, {}, [](const IntersectionRecord& place) {
    return std::tuple(place.box.lo, place.box.hi, place.around);
  });
  return beside;
}

std::vector<IntersectionPlace> places_of(const std::vector<IntersectionRecord>& records) {
  std::vector<IntersectionPlace> places;
  places.reserve(records.size());
  for (const IntersectionRecord& record : records) places.push_back({record.box, record.around});
  return places;
}

}  // namespace

bool MendPlan::holds_all() {
  std::call_once(counted_, [&] {
    for (const CubeMeshes::Entry& entry : in_.places.entries()) places_count_ += entry.intersecting;
  });
  return places_count_ <= in_.room.most_places;
}

MendPlan::Boxes MendPlan::boxes(std::size_t unit) {
  return holds_all() ? planned_boxes(unit) : boxes_within_walls(unit);
}

std::uint64_t MendPlan::bytes() {
  if (!holds_all()) return 0;
  std::call_once(made_, [&] { make(); });
  return boxes_.capacity() * sizeof(MendBox) + reached_.capacity() * sizeof(reached_[0]) +
         beside_.capacity() * sizeof(IntersectionRecord);
}

void MendPlan::make() {
  std::map<Material, std::vector<IntersectionRecord>> places;
  const auto& entries = in_.places.entries();
  for (std::size_t i = 0; i < entries.size(); ++i)
    if (entries[i].intersecting > 0)
      for (const IntersectionRecord& record : CubeMeshArtifact(in_.places.path(i)).intersecting())
        places[record.label].push_back(record);
  for (const auto& of_label : places) {
    const Material label = of_label.first;
    const auto boxes = mend_boxes(places_of(of_label.second), in_.frame, in_.room);
    const auto beside = those_beside(of_label.second, boxes);
    beside_.insert(beside_.end(), beside.begin(), beside.end());
    for (const LatticeBox& box : boxes) {
      const auto number = static_cast<std::uint32_t>(boxes_.size());
      const Index3 lo = in_.cubes.cube_of(box.lo), hi = in_.cubes.cube_of(box.hi);
      boxes_.push_back({label, box, {label, in_.cubes.code(lo)}});
      each_index({lo, hi + splat(1)}, [&](Index3 cube) {
        reached_.emplace_back(CubeKey{label, in_.cubes.code(cube)}, number);
      });
    }
  }
  std::ranges::sort(reached_);
  std::ranges::stable_sort(beside_, {},
                           [&](const IntersectionRecord& record) { return begin_of(record); });
}

MendPlan::Boxes MendPlan::planned_boxes(std::size_t unit) {
  std::call_once(made_, [&] { make(); });
  const RefineUnit& own = in_.units[unit];
  const CubeKey begin{own.first_label, own.range.cubes.begin};
  const CubeKey end{own.end_label - 1, own.range.cubes.end};
  std::vector<std::uint32_t> numbers;
  auto at = std::ranges::lower_bound(reached_, begin, {}, [](const auto& r) { return r.first; });
  for (; at != reached_.end() && at->first < end; ++at) numbers.push_back(at->second);
  std::ranges::sort(numbers);
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  Boxes found;
  found.boxes.reserve(numbers.size());
  for (const std::uint32_t number : numbers) found.boxes.push_back(boxes_[number]);
  const auto first_of = [&](const CubeKey& cube) {
    return std::ranges::lower_bound(
        beside_, cube, {}, [&](const IntersectionRecord& record) { return begin_of(record); });
  };
  found.beside.assign(first_of(begin), first_of(end));
  return found;
}

// Units are sorted by label, and of a label by cubes; one of several labels has all their cubes.
std::size_t MendPlan::unit_at(const CubeKey& cube) const {
  const auto above = std::ranges::upper_bound(in_.units, cube, {}, [](const RefineUnit& unit) {
    return CubeKey{unit.first_label, unit.range.cubes.begin};
  });
  return static_cast<std::size_t>(std::max<std::ptrdiff_t>(above - in_.units.begin(), 1) - 1);
}

bool MendPlan::reaches(std::size_t unit, Material label, const LatticeBox& box) const {
  bool any = false;
  each_index({in_.cubes.cube_of(box.lo), in_.cubes.cube_of(box.hi) + splat(1)}, [&](Index3 cube) {
    any = any || unit_at({label, in_.cubes.code(cube)}) == unit;
  });
  return any;
}

// The units that have to know of places in the list: those that their cubes at the walls reach into, and
// those in whose cubes they begin.
MendPlan::Near MendPlan::near_list(std::uint32_t list) const {
  std::map<Material, std::set<std::uint64_t>> walls, begins;  // Morton numbers of cubes
  for (const IntersectionRecord& record : CubeMeshArtifact(in_.places.path(list)).intersecting()) {
    begins[record.label].insert(morton_encode(in_.cubes.cube_of(record.box.lo)));
    const Index3 cube = walls_.cube_of(record.box.lo);
    if (cube == walls_.cube_of(record.box.hi)) walls[record.label].insert(morton_encode(cube));
  }
  Near near;
  const auto add = [&](Material label, Index3 cube) {
    near.emplace_back(static_cast<std::uint32_t>(unit_at({label, in_.cubes.code(cube)})), list);
  };
  for (const auto& [label, cubes] : begins)
    for (const std::uint64_t cube : cubes) add(label, morton_decode(cube));
  for (const auto& of_label : walls)
    for (const std::uint64_t cube : of_label.second) {
      const LatticeBox box = walls_.box(morton_decode(cube));
      each_index({in_.cubes.cube_of(box.lo), in_.cubes.cube_of(box.hi) + splat(1)},
                 [&](Index3 reached) { add(of_label.first, reached); });
    }
  std::ranges::sort(near);
  near.erase(std::unique(near.begin(), near.end()), near.end());
  return near;
}

template <class F>
void MendPlan::each_record_near(std::size_t unit, F&& f) {
  std::call_once(looked_, [&] {
    std::vector<Near> near(in_.places.size());
    probe_all(near.size(),
              [&](std::size_t list) { near[list] = near_list(static_cast<std::uint32_t>(list)); });
    for (const Near& some : near) near_.insert(near_.end(), some.begin(), some.end());
    std::ranges::sort(near_);
  });
  const RefineUnit& own = in_.units[unit];
  auto at = std::ranges::lower_bound(near_, std::pair(static_cast<std::uint32_t>(unit), 0u));
  for (; at != near_.end() && at->first == unit; ++at)
    for (const IntersectionRecord& record : in_.places.open(at->second)->intersecting())
      if (record.label >= own.first_label && record.label < own.end_label) f(record);
}

MendPlan::Boxes MendPlan::boxes_within_walls(std::size_t unit) {
  const std::scoped_lock lock(planning_);
  struct OfLabel {
    std::vector<IntersectionPlace> places;
    std::vector<IntersectionRecord> own;  // that begin in the unit's cubes
  };
  std::map<Material, OfLabel> near;
  each_record_near(unit, [&](const IntersectionRecord& record) {
    const Index3 cube = walls_.cube_of(record.box.lo);
    OfLabel& of_label = near[record.label];
    if (cube == walls_.cube_of(record.box.hi) && reaches(unit, record.label, walls_.box(cube)))
      of_label.places.push_back({record.box, record.around});
    if (unit_at(begin_of(record)) == unit) of_label.own.push_back(record);
  });
  Boxes found;
  for (const auto& [label, of_label] : near) {
    found.places += of_label.places.size();
    const auto boxes = mend_boxes_within(of_label.places, in_.frame, in_.room, walls_);
    const auto beside = those_beside(of_label.own, boxes);
    found.beside.insert(found.beside.end(), beside.begin(), beside.end());
    for (const LatticeBox& box : boxes)
      if (reaches(unit, label, box))
        found.boxes.push_back({label, box, {label, in_.cubes.code(in_.cubes.cube_of(box.lo))}});
  }
  return found;
}

}  // namespace voxweld
