#include "stages/refine/refine_range.h"

#include <algorithm>
#include <map>
#include <span>
#include <unordered_map>

#include "stages/refine/box_refiner.h"
#include "stages/refine/fixed_pairs.h"
#include "stages/refine/refine_cube.h"
#include "stages/refine/vertex_cubes.h"
#include "storage/support/parallel.h"

namespace voxweld {
namespace {

constexpr std::size_t most_at_once = 8;  // cubes that are refined at the same time

struct Cube {
  std::uint64_t code = 0;    // of the range
  std::uint64_t number = 0;  // Morton code of the cube itself
  auto operator<=>(const Cube&) const = default;
};

class RangeRefiner {
 public:
  RangeRefiner(const RefineMesh& mesh, const CubeLattice& cubes, const CubeRange& own,
               const RefineParameters& parameters, RefineCounts& counts)
      : mesh_(mesh),
        cubes_(cubes),
        own_(own),
        parameters_(parameters),
        counts_(counts),
        places_(mesh, cubes),
        refiner_(mesh, parameters, counts) {}

  RefineMesh run() {
    sort_into_cubes();
    find_pairs();
    refine_cubes();
    return refiner_.take();
  }

  CollapseSurvey survey(const CubeLattice& others, std::span<const double> tolerances) {
    sort_into_cubes();
    CollapseSurvey sum;
    sum.left.resize(tolerances.size());
    for (const std::uint32_t t : crossing_) {
      if (!is_own(t)) continue;
      ++sum.fixed;
      const LatticeBox box = mesh_.box(t);
      sum.held += others.cube_of(box.lo) == others.cube_of(box.hi) ? 0 : 1;
    }
    Extract extract(mesh_);
    for (const auto& [cube, triangles] : populated_) {
      const auto room = room_of(morton_decode(cube.number));
      if (!room) continue;
      each_part(
          mesh_, *room, triangles,
          [&](const LatticeBox& part, const TriangleNumbers& inside) {
            const RefineMesh mesh = extract.of(inside);
            sum.add(survey_cube(mesh, part, parameters_, tolerances));
          },
          [&](std::uint32_t) { ++sum.fixed; });
    }
    return sum;
  }

 private:
  bool is_own(std::size_t triangle) const {
    return own_.contains(cubes_.code(places_.home(triangle)));
  }
  // Nothing where no point of the cube may move.
  std::optional<Room> room_of(Index3 cube) const {
    Room room{cubes_.box(cube), cubes_.whole(cube)};
    if (!parameters_.within) return room;
    if (!room.box.meets(*parameters_.within)) return std::nullopt;
    room.box = room.box.common(*parameters_.within);
    return room;
  }
  class CubeLists;
  void sort_into_cubes();
  void find_pairs();
  using Populated = std::map<Cube, TriangleNumbers>;
  void refine_cubes();
  TriangleNumbers staying_in(Index3 cube, const TriangleNumbers& meeting,
                             const std::optional<Room>& room) const;

  const RefineMesh& mesh_;
  const CubeLattice& cubes_;
  const CubeRange& own_;
  const RefineParameters& parameters_;
  RefineCounts& counts_;
  const VertexCubes places_;
  BoxRefiner refiner_;
  std::vector<Extract> extracts_;  // for cubes or parts that are refined at the same time
  Populated populated_;            // with triangles at home: all that meet the cube
  TriangleNumbers crossing_;       // triangles with corners in several cubes
  TriangleNumbers fixed_;          // that intersect others that are fixed too
};

// Most triangles lie in the cube of the one before, which is not looked up again.
class RangeRefiner::CubeLists {
 public:
  // Null where there is none.
  TriangleNumbers* of(Index3 cube) {
    if (cube == last_) return list_;
    last_ = cube;
    const auto at = lists_.find(morton_encode(cube));
    return list_ = at == lists_.end() ? nullptr : at->second;
  }
  void add(Index3 cube, TriangleNumbers& list) {
    lists_.try_emplace(morton_encode(cube), &list);
    last_ = {-1, -1, -1};
  }

 private:
  std::unordered_map<std::uint64_t, TriangleNumbers*> lists_;
  Index3 last_{-1, -1, -1};
  TriangleNumbers* list_ = nullptr;
};

void RangeRefiner::sort_into_cubes() {
  CubeLists lists;
  const auto is_own_cube = [&](Index3 cube) {
    if (lists.of(cube) != nullptr) return true;
    const std::uint64_t code = cubes_.code(cube);
    if (!own_.contains(code)) return false;
    lists.add(cube, populated_[{code, morton_encode(cube)}]);
    return true;
  };
  const auto count = static_cast<std::uint32_t>(mesh_.triangles.size());
  std::vector<bool> used(mesh_.positions.size());
  std::uint64_t triangles = 0;
  for (std::uint32_t t = 0; t < count; ++t) {
    if (!places_.is_inside(t)) crossing_.push_back(t);
    if (!is_own_cube(places_.home(t))) continue;
    ++triangles;
    for (const std::uint32_t v : mesh_.triangles[t]) used[v] = true;
  }
  const auto vertices = static_cast<std::uint64_t>(std::count(used.begin(), used.end(), true));
  std::uint64_t samples = vertices;  // that go or move
  for (const SurfaceSample& sample : mesh_.samples) samples += is_own(sample.triangle) ? 1 : 0;
  refiner_.reserve({vertices, triangles, samples, mesh_.sides.empty() ? 0 : triangles});
  for (std::uint32_t t = 0; t < count; ++t)
    each_index(places_.around(t), [&](Index3 cube) {
      if (TriangleNumbers* list = lists.of(cube)) list->push_back(t);
    });
}

void RangeRefiner::find_pairs() {
  if (parameters_.intersections == IntersectionRule::ignore) return;
  std::vector<FixedTriangle> fixed;
  for (const std::uint32_t t : crossing_) fixed.push_back({t, false, is_own(t)});
  for (const auto& [cube, triangles] : populated_) {
    const auto room = room_of(morton_decode(cube.number));
    if (!room) continue;
    each_part(
        mesh_, *room, triangles, [](const auto&, const auto&) {},
        [&](std::uint32_t t) {
          fixed.push_back({t, true, true});
        });
  }
  FixedPairs found = find_fixed_pairs(mesh_, fixed);
  fixed_ = std::move(found.intersecting);
  counts_.pairs_before += found.pairs;
  counts_.pairs_left += found.pairs;
}

// What is at home in the cube and may not change.
TriangleNumbers RangeRefiner::staying_in(Index3 cube, const TriangleNumbers& meeting,
                                         const std::optional<Room>& room) const {
  TriangleNumbers staying;
  for (const std::uint32_t t : meeting)
    if (places_.home(t) == cube && !(room && lies_in(mesh_, t, room->box))) staying.push_back(t);
  return staying;
}

// As many cubes at the same time as have no more triangles than parameters say: so threads that are free
// help, and memory is bounded.
void RangeRefiner::refine_cubes() {
  std::vector<std::pair<Index3, const TriangleNumbers*>> cubes;
  std::size_t largest = 0;
  for (const auto& [cube, triangles] : populated_) {
    cubes.emplace_back(morton_decode(cube.number), &triangles);
    largest = std::max(largest, triangles.size());
  }
  // One that is cut up is alone, and its parts are done at the same time.
  const auto is_cut = [&](std::size_t i) { return cubes[i].second->size() > most_part_triangles; };
  const std::size_t slots =
      largest > most_part_triangles ? most_at_once : std::min(most_at_once, cubes.size());
  while (extracts_.size() < slots) extracts_.emplace_back(mesh_);
  std::vector<std::optional<BoxRefiner::Outcome>> outcomes(slots);
  const auto size = [&](std::size_t i) {
    return is_cut(i) ? parameters_.at_once + 1 : cubes[i].second->size();
  };
  const auto work = [&](std::size_t i, std::size_t slot) {
    const auto& [cube, meeting] = cubes[i];
    const auto room = room_of(cube);
    const TriangleNumbers staying = staying_in(cube, *meeting, room);
    const auto extracts = is_cut(i) ? std::span(extracts_) : std::span(extracts_).subspan(slot, 1);
    if (room)
      outcomes[slot] = refiner_.work_on({*room, *meeting, staying, fixed_}, extracts);
    else
      outcomes[slot] = refiner_.kept(staying, fixed_);
  };
  const auto put = [&](std::size_t, std::size_t slot) {
    refiner_.put_out(*outcomes[slot]);
    outcomes[slot].reset();
  };
  for_each_in_order({cubes.size(), size, work, put}, slots, parameters_.at_once);
  counts_.cubes += cubes.size();
}

}  // namespace

Index3 home_of(const RefineMesh& mesh, std::size_t triangle, const CubeLattice& cubes) {
  return cubes.cube_of(mesh.positions[mesh.triangles[triangle][0]]);
}

RefineMesh refine_range(const RefineMesh& mesh, const CubeLattice& cubes, const CubeRange& own,
                        const RefineParameters& parameters, RefineCounts& counts) {
  return RangeRefiner(mesh, cubes, own, parameters, counts).run();
}

CollapseSurvey survey_range(const RefineMesh& mesh, const CubeLattice& cubes,
                            const CubeLattice& others, const CubeRange& own,
                            const RefineParameters& parameters,
                            std::span<const double> tolerances) {
  RefineCounts counts;
  return RangeRefiner(mesh, cubes, own, parameters, counts).survey(others, tolerances);
}

std::uint64_t refine_bytes(const MeshSize& all, const MeshSize& own, std::size_t at_once) {
  // Cubes of vertices and their numbers in what is put together, lists of triangles; then of the cube
  // at hand what was done and what is to be put in order; and what comes out.
  const std::uint64_t sorting =
      all.vertices * (VertexCubes::bytes + 4 + 4 * most_at_once) + all.triangles * 12;
  const std::uint64_t done = mesh_bytes(own.vertices, own.triangles, own.samples, own.sided) +
                             own.vertices * 4 + own.triangles * 32;
  const std::uint64_t out = gather_bytes(own.vertices, own.triangles, own.samples, own.sided);
  // EditMesh and the queue of edges.
  const std::uint64_t edited = std::min<std::uint64_t>(all.triangles, at_once) * 320 +
                               std::min<std::uint64_t>(all.sided, at_once) * 32;
  return sorting + done + out + edited;
}

}  // namespace voxweld
