#include <algorithm>
#include <numeric>

#include "pipeline/executor/probe.h"
#include "pipeline/refine/box_reads.h"

namespace voxweld {

bool MendPlan::holds_all() {
  std::call_once(counted_, [&] {
    in_.places.entries();  // or one is missing
    std::vector<std::uint64_t> counts(in_.places.size());
    probe_all(counts.size(), [&](std::size_t i) {
      counts[i] = CubeMeshArtifact(in_.places.path(i)).intersecting_count();
    });
    places_count_ = std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
  });
  return places_count_ <= in_.room.most_places;
}

std::vector<MendBox> MendPlan::boxes(std::size_t unit, std::uint64_t& places) {
  places = 0;
  return holds_all() ? planned_boxes(unit) : boxes_within_walls(unit, places);
}

void MendPlan::make() {
  std::map<Material, std::vector<IntersectionPlace>> places;
  for (std::size_t i = 0; i < in_.places.size(); ++i)
    for (const IntersectionRecord& record : CubeMeshArtifact(in_.places.path(i)).intersecting())
      places[record.label].push_back({record.box, record.around});
  for (auto& of_label : places) {
    const Material label = of_label.first;
    for (const LatticeBox& box : mend_boxes(std::move(of_label.second), in_.frame, in_.room)) {
      const auto number = static_cast<std::uint32_t>(boxes_.size());
      const Index3 lo = in_.cubes.cube_of(box.lo), hi = in_.cubes.cube_of(box.hi);
      boxes_.push_back({label, box, {label, in_.cubes.code(lo)}});
      each_index({lo, hi + splat(1)}, [&](Index3 cube) {
        reached_.emplace_back(CubeKey{label, in_.cubes.code(cube)}, number);
      });
    }
  }
  std::ranges::sort(reached_);
}

std::vector<MendBox> MendPlan::planned_boxes(std::size_t unit) {
  std::call_once(made_, [&] { make(); });
  const RefineUnit& own = in_.units[unit];
  const CubeKey begin{own.first_label, own.range.cubes.begin};
  const CubeKey end{own.end_label - 1, own.range.cubes.end};
  std::vector<std::uint32_t> numbers;
  auto at = std::ranges::lower_bound(reached_, begin, {}, [](const auto& r) { return r.first; });
  for (; at != reached_.end() && at->first < end; ++at) numbers.push_back(at->second);
  std::ranges::sort(numbers);
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  std::vector<MendBox> boxes;
  boxes.reserve(numbers.size());
  for (const std::uint32_t number : numbers) boxes.push_back(boxes_[number]);
  return boxes;
}

// Units are sorted by label, and of a label by cubes; one of several labels has all their cubes.
std::size_t MendPlan::unit_at(const CubeKey& cube) const {
  const auto above = std::ranges::upper_bound(in_.units, cube, {}, [](const RefineUnit& unit) {
    return CubeKey{unit.first_label, unit.range.cubes.begin};
  });
  return static_cast<std::size_t>(std::max<std::ptrdiff_t>(above - in_.units.begin(), 1) - 1);
}

// A cube at the walls has places of two cubes of the first pass beside each other on each axis, at most.
void MendPlan::find_neighbours() {
  for (std::uint32_t unit = 0; unit < in_.units.size(); ++unit)
    neighbours_.emplace_back(unit, unit);
  if (in_.room.walls == 0) return;
  for (std::size_t i = 0; i < in_.meshes.size(); ++i) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> some;
    const auto artifact = in_.meshes.open(i);
    for (const CubePieceRecord& piece : artifact->pieces()) {
      const auto own = static_cast<std::uint32_t>(unit_at(piece.key()));
      const Index3 cube = morton_decode(piece.cube);
      each_index({splat(-1), splat(2)}, [&](Index3 step) {
        const Index3 beside = cube + step;
        if (beside.x < 0 || beside.y < 0 || beside.z < 0) return;
        const auto unit =
            static_cast<std::uint32_t>(unit_at({piece.label, in_.cubes.code(beside)}));
        if (unit != own && (some.empty() || some.back() != std::pair(unit, own)))
          some.emplace_back(unit, own);
      });
    }
    std::ranges::sort(some);
    some.erase(std::unique(some.begin(), some.end()), some.end());
    neighbours_.insert(neighbours_.end(), some.begin(), some.end());
  }
  std::ranges::sort(neighbours_);
  neighbours_.erase(std::unique(neighbours_.begin(), neighbours_.end()), neighbours_.end());
}

bool MendPlan::reaches(std::size_t unit, Material label, const LatticeBox& box) const {
  bool any = false;
  each_index({in_.cubes.cube_of(box.lo), in_.cubes.cube_of(box.hi) + splat(1)}, [&](Index3 cube) {
    any = any || unit_at({label, in_.cubes.code(cube)}) == unit;
  });
  return any;
}

std::vector<MendBox> MendPlan::boxes_within_walls(std::size_t unit, std::uint64_t& places) {
  std::call_once(neighbours_found_, [&] { find_neighbours(); });
  const RefineUnit& own = in_.units[unit];
  std::map<Material, std::vector<IntersectionPlace>> near;
  auto at = std::ranges::lower_bound(neighbours_, std::pair(static_cast<std::uint32_t>(unit), 0u));
  for (; at != neighbours_.end() && at->first == unit; ++at)
    for (const IntersectionRecord& record : in_.places.open(at->second)->intersecting()) {
      if (record.label < own.first_label || record.label >= own.end_label) continue;
      const Index3 cube = walls_.cube_of(record.box.lo);
      if (cube == walls_.cube_of(record.box.hi) && reaches(unit, record.label, walls_.box(cube)))
        near[record.label].push_back({record.box, record.around});
    }
  std::vector<MendBox> boxes;
  for (const auto& [label, of_label] : near) {
    places += of_label.size();
    for (const LatticeBox& box : mend_boxes_within(of_label, in_.frame, in_.room, walls_))
      if (reaches(unit, label, box))
        boxes.push_back({label, box, {label, in_.cubes.code(in_.cubes.cube_of(box.lo))}});
  }
  return boxes;
}

}  // namespace voxweld
