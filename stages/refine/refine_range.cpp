#include "stages/refine/refine_range.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <unordered_map>

#include "stages/refine/edit_mesh.h"
#include "stages/refine/fixed_pairs.h"
#include "stages/refine/mesh_part.h"
#include "stages/refine/nearest_triangle.h"
#include "stages/refine/refine_cube.h"

namespace voxweld {
namespace {

// A cube that more triangles meet is done in eight parts, so that memory is bounded.
constexpr std::size_t most_triangles = std::size_t{1} << 16;
constexpr std::int32_t least_side = 64;  // of a part, in lattice steps

using Triangles = std::vector<std::uint32_t>;

struct Cube {
  std::uint64_t code = 0;    // of the range
  std::uint64_t number = 0;  // Morton code of the cube itself
  auto operator<=>(const Cube&) const = default;
};

bool lies_in(const RefineMesh& mesh, std::uint32_t t, const LatticeBox& box) {
  return std::ranges::all_of(mesh.triangles[t],
                             [&](std::uint32_t v) { return box.contains(mesh.positions[v]); });
}

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

class RangeRefiner {
 public:
  RangeRefiner(const RefineMesh& mesh, const CubeLattice& cubes, const CubeRange& own,
               const RefineParameters& parameters, RefineCounts& counts)
      : mesh_(mesh),
        cubes_(cubes),
        own_(own),
        parameters_(parameters),
        counts_(counts),
        extract_(mesh) {}

  RefineMesh run() {
    sort_into_cubes();
    find_pairs();
    for (const auto& [cube, triangles] : populated_) {
      ++counts_.cubes;
      refine_one(morton_decode(cube.number), triangles);
    }
    RefineMesh result = out_.take();
    result.checked = parameters_.intersections != IntersectionRule::ignore;
    return result;
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
    for (const auto& [cube, triangles] : populated_) {
      each_part(
          cubes_.box(morton_decode(cube.number)), triangles,
          [&](const LatticeBox& part, const Triangles& inside) {
            const RefineMesh mesh = extract_.of(inside);
            sum.add(survey_cube(mesh, part, parameters_, tolerances));
          },
          [&](std::uint32_t) { ++sum.fixed; });
    }
    return sum;
  }

 private:
  // One triangle that comes out, before they are put in order.
  struct Done {
    std::uint32_t mesh : 31;  // 0: as it was, else of refined_, from 1 on
    std::uint32_t intersects : 1;
    std::uint32_t triangle;
    VertexId first;  // of its corners, which mostly tells the order
  };
  const RefineMesh& mesh_of(const Done& done) const {
    return done.mesh == 0 ? mesh_ : *refined_[done.mesh - 1];
  }
  void add_done(std::size_t mesh, std::uint32_t triangle, bool intersects) {
    Done done{static_cast<std::uint32_t>(mesh) & 0x7fffffffu, intersects ? 1u : 0u, triangle, {}};
    const RefineMesh& from = mesh_of(done);
    done.first = from.ids[from.triangles[triangle][0]];
    done_.push_back(done);
  }

  void sort_into_cubes();
  void find_pairs();
  void refine_one(Index3 cube, const Triangles& triangles);
  template <class OnPart, class OnLeft>
  void each_part(const LatticeBox& box, const Triangles& triangles, OnPart&& on_part,
                 OnLeft&& on_left) const;
  bool stays(const Triangles& triangles) const;
  void refine_part(const LatticeBox& box, const Triangles& triangles);
  void count_samples(const RefineMesh& mesh, std::uint32_t t);
  bool is_intersecting(std::uint32_t t) const {
    return std::binary_search(fixed_.begin(), fixed_.end(), t);
  }

  const RefineMesh& mesh_;
  const CubeLattice& cubes_;
  const CubeRange& own_;
  const RefineParameters& parameters_;
  RefineCounts& counts_;
  Extract extract_;
  std::map<Cube, Triangles> populated_;  // with triangles at home: all that meet the cube
  Triangles crossing_;                   // triangles with corners in several cubes
  Triangles fixed_;                      // that intersect others that are fixed too
  std::vector<std::unique_ptr<RefineMesh>> refined_;
  std::vector<Done> done_;  // of the cube at hand
  MeshGather out_;
};

void RangeRefiner::sort_into_cubes() {
  std::unordered_map<std::uint64_t, Triangles*> found;
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
  out_.reserve(vertices, triangles, samples, mesh_.sides.empty() ? 0 : triangles);
  for (std::uint32_t t = 0; t < count; ++t) {
    const LatticeBox box = mesh_.box(t);
    const Index3 lo = cubes_.cube_of(box.lo), hi = cubes_.cube_of(box.hi);
    each_index({lo, hi + splat(1)}, [&](Index3 cube) {
      const auto at = found.find(morton_encode(cube));
      if (at != found.end()) at->second->push_back(t);
    });
  }
}

// on_part(box, triangles) for the box, or its parts where it is cut up, with all that meets each;
// on_left(triangle) for what lies in the box but in no part.
template <class OnPart, class OnLeft>
void RangeRefiner::each_part(const LatticeBox& box, const Triangles& triangles, OnPart&& on_part,
                             OnLeft&& on_left) const {
  if (triangles.size() <= most_triangles || box.hi[0] - box.lo[0] < 2 * least_side)
    return on_part(box, triangles);
  const std::array<LatticeBox, 8> parts = octants(box);
  for (const LatticeBox& part : parts) {
    Triangles inside;
    for (const std::uint32_t t : triangles)
      if (mesh_.box(t).meets(part)) inside.push_back(t);
    each_part(part, inside, on_part, on_left);
  }
  for (const std::uint32_t t : triangles)
    if (lies_in(mesh_, t, box) &&
        std::ranges::none_of(parts, [&](const auto& part) { return lies_in(mesh_, t, part); }))
      on_left(t);
}

void RangeRefiner::find_pairs() {
  if (parameters_.intersections == IntersectionRule::ignore) return;
  std::vector<FixedTriangle> fixed;
  for (const std::uint32_t t : crossing_)
    fixed.push_back({t, false, own_.contains(cubes_.code(home_of(mesh_, t, cubes_)))});
  for (const auto& [cube, triangles] : populated_) {
    each_part(
        cubes_.box(morton_decode(cube.number)), triangles, [](const auto&, const auto&) {},
        [&](std::uint32_t t) {
          fixed.push_back({t, true, true});
        });
  }
  FixedPairs found = find_fixed_pairs(mesh_, fixed);
  fixed_ = std::move(found.intersecting);
  counts_.pairs_before += found.pairs;
  counts_.pairs_left += found.pairs;
}

// Whether it is known that nothing will be done.
bool RangeRefiner::stays(const Triangles& triangles) const {
  if (parameters_.mode == RefineMode::collapse) return false;
  if (parameters_.intersections == IntersectionRule::ignore) return true;
  return mesh_.checked &&
         std::ranges::none_of(triangles, [&](std::uint32_t t) { return mesh_.intersects(t); });
}

// All that lies in a box that is not cut up.
void RangeRefiner::refine_part(const LatticeBox& box, const Triangles& triangles) {
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

void RangeRefiner::refine_one(Index3 cube, const Triangles& triangles) {
  const LatticeBox box = cubes_.box(cube);
  each_part(
      box, triangles,
      [&](const LatticeBox& part, const Triangles& inside) { refine_part(part, inside); },
      [&](std::uint32_t t) { add_done(0, t, is_intersecting(t)); });
  for (const std::uint32_t t : triangles)
    if (home_of(mesh_, t, cubes_) == cube && !lies_in(mesh_, t, box))
      add_done(0, t, is_intersecting(t));
  std::sort(done_.begin(), done_.end(), [&](const Done& a, const Done& b) {
    if (a.first != b.first) return a.first < b.first;
    return mesh_of(a).ids_of(a.triangle) < mesh_of(b).ids_of(b.triangle);
  });
  for (const Done& done : done_) {
    out_.add_triangle(mesh_of(done), done.triangle, done.intersects != 0);
    count_samples(mesh_of(done), done.triangle);
  }
  done_.clear();
  refined_.clear();
}

void RangeRefiner::count_samples(const RefineMesh& mesh, std::uint32_t t) {
  const LatticeTriangle shape = mesh.shape(t);
  each_sample(mesh, t, [&](const SurfaceSample& s) {
    counts_.add_distance(std::sqrt(squared_distance(s.point, shape)));
  });
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
  const std::uint64_t part = std::min<std::uint64_t>(all.triangles, most_triangles) * 320 +
                             std::min<std::uint64_t>(all.sided, most_triangles) * 32;
  return sorting + done + out + part;
}

}  // namespace voxweld
