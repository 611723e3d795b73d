#include "stages/refine/refine_range.h"

#include <algorithm>
#include <map>
#include <unordered_map>

#include "stages/refine/box_refiner.h"
#include "stages/refine/fixed_pairs.h"
#include "stages/refine/refine_cube.h"

namespace voxweld {
namespace {

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
        refiner_(mesh, parameters, counts) {}

  RefineMesh run() {
    sort_into_cubes();
    find_pairs();
    for (const auto& [cube, triangles] : populated_) {
      ++counts_.cubes;
      refine_one(morton_decode(cube.number), triangles);
    }
    return refiner_.take();
  }

  CollapseSurvey survey(const CubeLattice& others, std::span<const double> tolerances) {
    sort_into_cubes();
    CollapseSurvey sum;
    sum.left.resize(tolerances.size());
    for (const std::uint32_t t : crossing_) {
      if (!own_.contains(cubes_.code(home_of(mesh_, t, cubes_)))) continue;
      ++sum.fixed;
      const LatticeBox box = mesh_.box(t);
      sum.held += others.cube_of(box.lo) == others.cube_of(box.hi) ? 0 : 1;
    }
    Extract extract(mesh_);
    for (const auto& [cube, triangles] : populated_) {
      each_part(
          mesh_, cubes_.box(morton_decode(cube.number)), triangles,
          [&](const LatticeBox& part, const TriangleNumbers& inside) {
            const RefineMesh mesh = extract.of(inside);
            sum.add(survey_cube(mesh, part, parameters_, tolerances));
          },
          [&](std::uint32_t) { ++sum.fixed; });
    }
    return sum;
  }

 private:
  void sort_into_cubes();
  void find_pairs();
  void refine_one(Index3 cube, const TriangleNumbers& triangles);

  const RefineMesh& mesh_;
  const CubeLattice& cubes_;
  const CubeRange& own_;
  const RefineParameters& parameters_;
  RefineCounts& counts_;
  BoxRefiner refiner_;
  std::map<Cube, TriangleNumbers> populated_;  // with triangles at home: all that meet the cube
  TriangleNumbers crossing_;                   // triangles with corners in several cubes
  TriangleNumbers fixed_;                      // that intersect others that are fixed too
};

void RangeRefiner::sort_into_cubes() {
  std::unordered_map<std::uint64_t, TriangleNumbers*> found;
  const auto count = static_cast<std::uint32_t>(mesh_.triangles.size());
  struct Place {
    std::uint16_t x, y, z;
    bool operator==(const Place&) const = default;
  };
  std::vector<Place> place_of;  // of each vertex its cube
  place_of.reserve(mesh_.positions.size());
  for (const LatticePoint& p : mesh_.positions) {
    const Index3 cube = cubes_.cube_of(p);
    place_of.push_back({static_cast<std::uint16_t>(cube.x), static_cast<std::uint16_t>(cube.y),
                        static_cast<std::uint16_t>(cube.z)});
  }
  std::vector<bool> used(mesh_.positions.size());
  std::uint64_t triangles = 0;
  for (std::uint32_t t = 0; t < count; ++t) {
    const auto& c = mesh_.triangles[t];
    const Place place = place_of[c[0]];
    const Index3 home{place.x, place.y, place.z};
    if (place_of[c[1]] != place || place_of[c[2]] != place) crossing_.push_back(t);
    const std::uint64_t code = cubes_.code(home), number = morton_encode(home);
    if (!own_.contains(code)) continue;
    found.try_emplace(number, &populated_[{code, number}]);
    ++triangles;
    for (const std::uint32_t v : c) used[v] = true;
  }
  const auto vertices = static_cast<std::uint64_t>(std::count(used.begin(), used.end(), true));
  std::uint64_t samples = vertices;  // that go or move
  for (const SurfaceSample& sample : mesh_.samples)
    samples += own_.contains(cubes_.code(home_of(mesh_, sample.triangle, cubes_))) ? 1 : 0;
  refiner_.reserve({vertices, triangles, samples, mesh_.sides.empty() ? 0 : triangles});
  for (std::uint32_t t = 0; t < count; ++t) {
    const LatticeBox box = mesh_.box(t);
    const Index3 lo = cubes_.cube_of(box.lo), hi = cubes_.cube_of(box.hi);
    each_index({lo, hi + splat(1)}, [&](Index3 cube) {
      const auto at = found.find(morton_encode(cube));
      if (at != found.end()) at->second->push_back(t);
    });
  }
}

void RangeRefiner::find_pairs() {
  if (parameters_.intersections == IntersectionRule::ignore) return;
  std::vector<FixedTriangle> fixed;
  for (const std::uint32_t t : crossing_)
    fixed.push_back({t, false, own_.contains(cubes_.code(home_of(mesh_, t, cubes_)))});
  for (const auto& [cube, triangles] : populated_) {
    each_part(
        mesh_, cubes_.box(morton_decode(cube.number)), triangles, [](const auto&, const auto&) {},
        [&](std::uint32_t t) {
          fixed.push_back({t, true, true});
        });
  }
  FixedPairs found = find_fixed_pairs(mesh_, fixed);
  fixed_ = std::move(found.intersecting);
  counts_.pairs_before += found.pairs;
  counts_.pairs_left += found.pairs;
}

void RangeRefiner::refine_one(Index3 cube, const TriangleNumbers& triangles) {
  const LatticeBox box = cubes_.box(cube);
  TriangleNumbers leaving;
  for (const std::uint32_t t : triangles)
    if (home_of(mesh_, t, cubes_) == cube && !lies_in(mesh_, t, box)) leaving.push_back(t);
  refiner_.refine({box, triangles, leaving, fixed_});
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

std::uint64_t refine_bytes(const MeshSize& all, const MeshSize& own) {
  // Cubes of vertices, lists of triangles; then of the cube at hand what was done and what is to be
  // put in order; and what comes out.
  const std::uint64_t sorting = all.vertices * 6 + all.triangles * 12;
  const std::uint64_t done =
      mesh_bytes(own.vertices, own.triangles, own.samples, own.sided) + own.triangles * 32;
  const std::uint64_t out = gather_bytes(own.vertices, own.triangles, own.samples, own.sided);
  // EditMesh and the queue of edges of one part.
  const std::uint64_t part = std::min<std::uint64_t>(all.triangles, most_part_triangles) * 320 +
                             std::min<std::uint64_t>(all.sided, most_part_triangles) * 32;
  return sorting + done + out + part;
}

}  // namespace voxweld
