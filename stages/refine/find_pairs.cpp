#include "stages/refine/find_pairs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "stages/refine/box_pairs.h"
#include "stages/refine/plane_tests.h"
#include "stages/refine/umbrella.h"
#include "stages/refine/vertex_cubes.h"
#include "storage/types/index_table.h"

namespace voxweld {
namespace {

using Corners = std::array<std::uint32_t, 3>;

// A normal, rounded: its signs are exact.
using Direction = float __attribute__((vector_size(16)));

bool have_common_vertex(const Corners& a, const Corners& b) {
  bool common = false;
  for (const std::uint32_t v : a) common |= (v == b[0]) | (v == b[1]) | (v == b[2]);
  return common;
}

// What is known of the triangles around a vertex.
struct Star {
  Direction sum{};            // of their normals
  std::uint64_t balance = 0;  // of each triangle the vertex behind it less the one before it, mixed
  std::uint32_t changes = 0;  // of the side of the vertex on which what is around it lies
  std::uint32_t triangle = 0;  // the last one of them
  std::uint8_t axis = 0;       // along which the sum is largest
  bool any_own = false;
  bool bends = false;   // normals do not all go the sum's way along the axis
  bool sheets = false;  // several meet: their shadows may lie on each other

  // Whether the triangles make rings: nothing is left in the balance, but for a chance of 2^-64.
  bool is_ring() const { return !sheets && balance == 0; }
  // Whether they run the same way, seen along the axis, and once around the vertex. Then none of them
  // intersect.
  bool is_proper() const { return is_ring() && !bends && changes == 2; }
};

class PairFinder {
 public:
  PairFinder(const RefineMesh& mesh, const CubeLattice& cubes, const CubeRange& own)
      : mesh_(mesh), own_(mesh.triangles.size()), inside_(mesh.triangles.size()) {
    const VertexCubes places(mesh, cubes);
    Index3 home{-1, -1, -1};
    std::uint8_t is_own = 0;  // a triangle at home there
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      if (const Index3 cube = places.home(t); cube != home) {
        home = cube;
        is_own = own.contains(cubes.code(cube)) ? 1 : 0;
      }
      own_[t] = is_own;
      inside_[t] = places.is_inside(t) ? 1 : 0;
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
  struct Rib {
    std::uint32_t triangle;
    LatticeTriangle shape;
    Index3 normal;
  };
  void add_around_vertices();
  bool run_once_around(std::uint32_t v, const std::vector<Rib>& ribs) const;
  void add_pairs_of(const std::vector<Rib>& ribs);
  std::vector<Star> find_stars() const;
  void add_apart();
  Index3 normal(std::uint32_t t) const {
    const LatticeTriangle s = mesh_.shape(t);
    return exact_normal(s[0], s[1], s[2]);
  }
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
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs_;
};

// Of pairs that share a vertex.
void PairFinder::add_around_vertices() {
  enum : std::uint8_t { proper, ring, other };
  std::vector<std::uint8_t> stars;
  stars.reserve(mesh_.positions.size());
  for (const Star& star : find_stars())
    stars.push_back(!star.any_own || star.is_proper() ? proper : star.is_ring() ? ring : other);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> corners;  // vertex, triangle
  for (std::uint32_t t = 0; t < own_.size(); ++t)
    for (const std::uint32_t v : mesh_.triangles[t])
      if (stars[v] != proper) corners.emplace_back(v, t);
  std::ranges::sort(corners);
  std::vector<Rib> ribs;  // of one vertex
  for (std::size_t i = 0; i < corners.size();) {
    const std::uint32_t v = corners[i].first;
    ribs.clear();
    for (; i < corners.size() && corners[i].first == v; ++i) {
      const std::uint32_t t = corners[i].second;
      ribs.push_back({t, mesh_.shape(t), normal(t)});
    }
    if (stars[v] != ring || !run_once_around(v, ribs)) add_pairs_of(ribs);
  }
}

// A closer look than along axes. Precondition: they make a ring.
bool PairFinder::run_once_around(std::uint32_t v, const std::vector<Rib>& ribs) const {
  Vec3 sum;
  for (const Rib& rib : ribs) sum = sum + as_vec3(rib.normal);
  ShadowTurns turns(direction_of(sum));
  for (const Rib& rib : ribs) {
    const Corners& c = mesh_.triangles[rib.triangle];
    const std::size_t k = c[0] == v ? 0 : c[1] == v ? 1 : 2;
    if (!turns.add(rib.shape[k], rib.shape[(k + 1) % 3], rib.shape[(k + 2) % 3], rib.normal))
      return false;
  }
  return turns.once();
}

void PairFinder::add_pairs_of(const std::vector<Rib>& ribs) {
  for (std::size_t i = 0; i < ribs.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Rib &a = ribs[i], &b = ribs[j];
      if (own_[a.triangle] + own_[b.triangle] > 0 &&
          intersect_by_planes(a.shape, a.normal, b.shape, b.normal))
        add(a.triangle, b.triangle);
    }
}

// Triangles come one after the other, and not those of each vertex: so they need no lists.
std::vector<Star> PairFinder::find_stars() const {
  std::vector<Direction> normals(own_.size());
  std::vector<Star> stars(mesh_.positions.size());
  for (std::uint32_t t = 0; t < own_.size(); ++t) {
    const Index3 exact = normal(t);
    for (int a = 0; a < 3; ++a) normals[t][a] = static_cast<float>(exact[a]);
    for (const std::uint32_t v : mesh_.triangles[t]) {
      stars[v].sum += normals[t];
      stars[v].triangle = t;
    }
  }
  for (Star& star : stars)
    for (std::uint8_t a = 1; a < 3; ++a)
      if (std::abs(star.sum[a]) > std::abs(star.sum[star.axis])) star.axis = a;
  const auto& sides = mesh_.sides;
  for (std::uint32_t t = 0; t < own_.size(); ++t) {
    const Corners& c = mesh_.triangles[t];
    const LatticeTriangle shape = mesh_.shape(t);
    const std::uint64_t marks[3] = {mix_bits(c[0]), mix_bits(c[1]), mix_bits(c[2])};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3, last = (k + 2) % 3;
      Star& star = stars[c[k]];
      const std::size_t axis = star.axis, up = axis == 2 ? 0 : axis + 1;
      star.bends |= !(normals[t][axis] * star.sum[axis] > 0);
      star.sheets |= !sides.empty() && sides[t] != sides[star.triangle];
      star.changes += (shape[next][up] < shape[k][up]) != (shape[last][up] < shape[k][up]);
      star.balance += marks[next] - marks[last];
      star.any_own |= own_[t] != 0;
    }
  }
  return stars;
}

// Of pairs that share none.
void PairFinder::add_apart() {
  std::vector<LatticeBox> boxes;
  boxes.reserve(own_.size());
  for (std::size_t t = 0; t < own_.size(); ++t) boxes.push_back(mesh_.box(t));
  BoxPairs(boxes).each([&](std::uint32_t a, std::uint32_t b) {
    if (own_[a] + own_[b] > 0 && !have_common_vertex(mesh_.triangles[a], mesh_.triangles[b]) &&
        !lie_apart(mesh_.shape(a), normal(a), mesh_.shape(b), normal(b)))
      add(a, b);
  });
}

}  // namespace

FoundPairs find_range_pairs(const RefineMesh& mesh, const CubeLattice& cubes,
                            const CubeRange& own) {
  return PairFinder(mesh, cubes, own).run();
}

std::uint64_t find_pairs_bytes(const MeshSize& all) {
  // Of vertices their cubes, or stars, and of triangles normals and what is around vertices that are not
  // proper, or boxes, and these as pairs are found.
  constexpr std::uint64_t around = sizeof(Direction) + 6 * sizeof(std::uint64_t);
  return all.triangles * (2 + std::max<std::uint64_t>(around, 2 * sizeof(LatticeBox))) +
         box_pairs_bytes(all.triangles) +
         all.vertices * std::max<std::uint64_t>(VertexCubes::bytes, sizeof(Star));
}

}  // namespace voxweld
