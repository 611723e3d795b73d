#include "stages/refine/find_pairs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "stages/refine/box_pairs.h"
#include "stages/refine/plane_tests.h"
#include "stages/refine/vertex_cubes.h"

namespace voxweld {
namespace {

using Corners = std::array<std::uint32_t, 3>;

// A triangle around a vertex, the vertex first.
struct Rib {
  std::uint32_t triangle = 0, next = 0, last = 0;  // its other two vertices
};

bool have_common_vertex(const Corners& a, const Corners& b) {
  bool common = false;
  for (const std::uint32_t v : a) common |= (v == b[0]) | (v == b[1]) | (v == b[2]);
  return common;
}

// Whether each triangle has a neighbour on either side and none has two: then they make rings around
// the vertex.
bool are_closed(const std::vector<Rib>& ribs) {
  return std::ranges::all_of(ribs, [&](const Rib& rib) {
    int after = 0, alike = 0;
    for (const Rib& other : ribs) {
      after += other.last == rib.next ? 1 : 0;
      alike += other.next == rib.next ? 1 : 0;
    }
    return after == 1 && alike == 1;
  });
}

class PairFinder {
 public:
  PairFinder(const RefineMesh& mesh, const CubeLattice& cubes, const CubeRange& own)
      : mesh_(mesh),
        own_(mesh.triangles.size()),
        inside_(mesh.triangles.size()),
        planes_(mesh.triangles.size()) {
    const VertexCubes places(mesh, cubes);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      own_[t] = own.contains(cubes.code(places.home(t))) ? 1 : 0;
      inside_[t] = places.is_inside(t) ? 1 : 0;
      const LatticeTriangle s = mesh.shape(t);
      planes_[t] = exact_normal(s[0], s[1], s[2]);
    }
  }

  FoundPairs run() {
    if (mesh_.triangles.empty()) return {};
    add_around_vertices();
    add_apart();
    FoundPairs found;
    std::ranges::sort(pairs_);
    pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
    for (const auto& [a, b] : pairs_) {
      found.pairs += own_[counted_by(a, b)];
      for (const std::uint32_t t : {a, b})
        if (own_[t] != 0 && (inside_[a] == inside_[b] || inside_[t] != 0))
          found.intersecting.push_back(t);
    }
    std::ranges::sort(found.intersecting);
    found.intersecting.erase(std::unique(found.intersecting.begin(), found.intersecting.end()),
                             found.intersecting.end());
    return found;
  }

 private:
  void add_around_vertices();
  bool is_proper(const LatticePoint& at, const std::vector<Rib>& ribs) const;
  void add_apart();
  // Of a pair the triangle in whose range it is counted. A range knows others' triangles only where
  // those leave their cube.
  std::uint32_t counted_by(std::uint32_t a, std::uint32_t b) const {
    if (inside_[a] != inside_[b]) return inside_[a] != 0 ? a : b;
    return mesh_.ids_of(a) < mesh_.ids_of(b) ? a : b;
  }
  void add(std::uint32_t a, std::uint32_t b) {
    pairs_.emplace_back(std::min(a, b), std::max(a, b));
  }

  const RefineMesh& mesh_;
  std::vector<std::uint8_t> own_, inside_;  // at home in the range; all in one cube
  std::vector<Index3> planes_;              // exact normals
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs_;
};

// Of pairs that share a vertex.
void PairFinder::add_around_vertices() {
  std::vector<std::uint32_t> begins(mesh_.positions.size() + 1), corners(3 * own_.size());
  for (const Corners& c : mesh_.triangles)
    for (const std::uint32_t v : c) ++begins[v];
  std::partial_sum(begins.begin(), begins.end(), begins.begin());
  for (auto t = static_cast<std::uint32_t>(own_.size()); t-- > 0;)
    for (std::uint32_t k = 0; k < 3; ++k) corners[--begins[mesh_.triangles[t][k]]] = 3 * t + k;
  std::vector<Rib> ribs;
  for (std::uint32_t v = 0; v < mesh_.positions.size(); ++v) {
    ribs.clear();
    bool any_own = false;
    for (std::uint32_t i = begins[v]; i < begins[v + 1]; ++i) {
      const std::uint32_t t = corners[i] / 3, k = corners[i] % 3;
      any_own = any_own || own_[t] != 0;
      ribs.push_back({t, mesh_.triangles[t][(k + 1) % 3], mesh_.triangles[t][(k + 2) % 3]});
    }
    if (!any_own || is_proper(mesh_.positions[v], ribs)) continue;
    for (std::size_t i = 0; i < ribs.size(); ++i)
      for (std::size_t j = i + 1; j < ribs.size(); ++j) {
        const std::uint32_t a = ribs[i].triangle, b = ribs[j].triangle;
        if (own_[a] + own_[b] > 0 &&
            intersect_by_planes(mesh_.shape(a), planes_[a], mesh_.shape(b), planes_[b]))
          add(a, b);
      }
  }
}

// Whether the triangles around a vertex at this place, seen along one axis, run the same way and once
// around it. Then none of them intersect.
bool PairFinder::is_proper(const LatticePoint& at, const std::vector<Rib>& ribs) const {
  std::array<double, 3> sums{};  // the axis along which they are largest together
  for (const Rib& rib : ribs)
    for (int a = 0; a < 3; ++a)
      sums[static_cast<std::size_t>(a)] += static_cast<double>(planes_[rib.triangle][a]);
  std::size_t axis = 0;
  for (std::size_t a = 1; a < 3; ++a)
    if (std::abs(sums[a]) > std::abs(sums[axis])) axis = a;
  const std::size_t up = (axis + 1) % 3;
  std::size_t changes = 0;
  for (const Rib& rib : ribs) {
    const std::int64_t along = planes_[rib.triangle][static_cast<int>(axis)];
    if (sums[axis] > 0 ? along <= 0 : along >= 0) return false;
    changes += (mesh_.positions[rib.next][up] < at[up]) != (mesh_.positions[rib.last][up] < at[up]);
  }
  // Where several sheets meet, their shadows may lie on each other.
  const auto& sides = mesh_.sides;
  const bool one_sheet = sides.empty() || std::ranges::all_of(ribs, [&](const Rib& rib) {
                           return sides[rib.triangle] == sides[ribs[0].triangle];
                         });
  return changes == 2 && one_sheet && are_closed(ribs);
}

// Of pairs that share none.
void PairFinder::add_apart() {
  std::vector<LatticeBox> boxes;
  boxes.reserve(own_.size());
  for (std::size_t t = 0; t < own_.size(); ++t) boxes.push_back(mesh_.box(t));
  BoxPairs(boxes).each([&](std::uint32_t a, std::uint32_t b) {
    if (own_[a] + own_[b] > 0 && !have_common_vertex(mesh_.triangles[a], mesh_.triangles[b]) &&
        !lie_apart(mesh_.shape(a), planes_[a], mesh_.shape(b), planes_[b]))
      add(a, b);
  });
}

}  // namespace

FoundPairs find_range_pairs(const RefineMesh& mesh, const CubeLattice& cubes,
                            const CubeRange& own) {
  return PairFinder(mesh, cubes, own).run();
}

std::uint64_t find_pairs_bytes(const MeshSize& all) {
  // Planes and corners; boxes, and these as pairs are found; of vertices their cubes and where their
  // corners begin.
  return all.triangles *
             (sizeof(Index3) + 2 + std::max<std::uint64_t>(12, 2 * sizeof(LatticeBox))) +
         box_pairs_bytes(all.triangles) + all.vertices * (VertexCubes::bytes + 4);
}

}  // namespace voxweld
