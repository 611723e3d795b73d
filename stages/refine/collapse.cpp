#include "stages/refine/collapse.h"

#include <algorithm>
#include <cmath>
#include <queue>

#include "stages/contouring/normal_clusters.h"
#include "stages/exact/orientation.h"
#include "stages/refine/edit_moves.h"
#include "stages/refine/quadric.h"

namespace voxweld {
namespace {

constexpr double least_cosine = 0.3;  // of a triangle's turn in one collapse

constexpr double large_triangle = 16;  // cells
constexpr double flat_cosine = 0.995;  // of 6 degrees

struct Edge {
  double cost;
  std::uint32_t u, v, version_u, version_v;
  // The cheapest first; equal ones in the order of their ids.
  bool operator<(const Edge& o) const {
    if (cost != o.cost) return cost > o.cost;
    return u != o.u ? u > o.u : v > o.v;
  }
};

Vec3 to_double(Index3 v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

class Collapser {
 public:
  Collapser(EditMesh& mesh, const RefineParameters& parameters, RefineCounts& counts)
      : mesh_(mesh),
        parameters_(parameters),
        counts_(counts),
        quadrics_(mesh.vertices()),
        moves_(mesh) {
    origin_ = mesh.box().lo;
    for (std::uint32_t t = 0; t < mesh.triangles(); ++t) add_plane(t);
    for (std::uint32_t v = 0; v < mesh.vertices(); ++v) push_around(v, true);
  }

  void run() {
    while (!queue_.empty()) {
      const Edge edge = queue_.top();
      queue_.pop();
      if (mesh_.version(edge.u) != edge.version_u || mesh_.version(edge.v) != edge.version_v ||
          mesh_.gone(edge.u) || mesh_.gone(edge.v))
        continue;
      try_edge(edge.u, edge.v);
    }
  }

 private:
  struct Candidate {
    double cost;  // mean distance
    LatticePoint at;
  };
  Vec3 local(const LatticePoint& p) const { return to_double(lattice_vector(origin_, p)); }
  LatticePoint lattice(Vec3 p) const {
    LatticePoint q{};
    for (std::size_t a = 0; a < 3; ++a)
      q[a] = static_cast<std::int32_t>(std::floor(p[static_cast<int>(a)] + 0.5)) + origin_[a];
    return q;
  }
  void add_plane(std::uint32_t t) {
    if (!mesh_.alive(t)) return;
    const LatticeTriangle s = mesh_.shape(t);
    const Vec3 n = to_double(mesh_.normal(t));
    const double length = std::sqrt(dot(n, n));
    if (!(length > 0)) return;
    const Vec3 unit = n * (1 / length);
    const Quadric q = Quadric::of_plane(unit, -dot(unit, local(s[0])), length);
    for (const std::uint32_t v : mesh_.corners(t)) quadrics_[v] += q;
  }
  // Which of two stays: the one others hold on to, else the one with the lower id.
  std::uint32_t keeper(std::uint32_t u, std::uint32_t v) const {
    if (mesh_.freedom(u) != mesh_.freedom(v)) return mesh_.freedom(u) == Freedom::free ? v : u;
    return std::min(u, v);
  }
  bool may_collapse(std::uint32_t u, std::uint32_t v) const {
    const Freedom a = mesh_.freedom(u), b = mesh_.freedom(v);
    return a != Freedom::fixed && b != Freedom::fixed && (a == Freedom::free || b == Freedom::free);
  }
  // Places for both, the cheapest first.
  struct Candidates {
    std::array<Candidate, 4> places;
    std::size_t count = 0;
    void add(const Candidate& one) {
      std::size_t at = count++;
      for (; at > 0 && one.cost < places[at - 1].cost; --at) places[at] = places[at - 1];
      places[at] = one;
    }
  };
  Candidates candidates(std::uint32_t u, std::uint32_t v) const;
  void push(std::uint32_t u, std::uint32_t v);
  void push_around(std::uint32_t v, bool upwards_only);
  void try_edge(std::uint32_t u, std::uint32_t v);
  bool turns_little() const;
  bool has_normals_for(std::uint32_t anchor) const;
  void set_normals(std::uint32_t u, std::uint32_t v, std::uint32_t keep, const LatticePoint& at);

  EditMesh& mesh_;
  const RefineParameters& parameters_;
  RefineCounts& counts_;
  LatticePoint origin_{};
  std::vector<Quadric> quadrics_;
  std::priority_queue<Edge> queue_;
  EditMoves moves_;
  Change change_;
};

Collapser::Candidates Collapser::candidates(std::uint32_t u, std::uint32_t v) const {
  Candidates out;
  Quadric q = quadrics_[u];
  q += quadrics_[v];
  const LatticePoint &a = mesh_.position(u), &b = mesh_.position(v);
  const auto add = [&](const LatticePoint& p) { out.add({q.distance(local(p)), p}); };
  const std::uint32_t keep = keeper(u, v);
  if (mesh_.freedom(keep) != Freedom::free) {
    add(mesh_.position(keep));
    return out;
  }
  const Vec3 middle = (local(a) + local(b)) * 0.5;
  Vec3 best = q.minimiser(middle);
  // Where the planes are nearly parallel it may lie far off.
  const Vec3 way = best - middle, edge = local(b) - local(a);
  if (dot(way, way) > 4 * dot(edge, edge)) best = middle;
  for (const LatticePoint& p : {lattice(best), lattice(middle)})
    if (mesh_.box().contains(p)) add(p);
  add(a);
  add(b);
  return out;
}

void Collapser::push(std::uint32_t u, std::uint32_t v) {
  if (!may_collapse(u, v)) return;
  const double cost = candidates(u, v).places[0].cost;
  if (cost > parameters_.tolerance) return;
  // Of places that are equally flat the small ones first: that keeps triangles in shape.
  const Vec3 edge = local(mesh_.position(v)) - local(mesh_.position(u));
  const double length = std::sqrt(dot(edge, edge));
  queue_.push({cost + 1e-3 * length, u, v, mesh_.version(u), mesh_.version(v)});
}

void Collapser::push_around(std::uint32_t v, bool upwards_only) {
  if (mesh_.freedom(v) == Freedom::fixed) return;
  mesh_.each_around(v, [&](std::uint32_t t) {
    // Each edge of a ring has one triangle in which it comes after v.
    const Corners& c = mesh_.corners(t);
    const std::size_t k = c[0] == v ? 0 : c[1] == v ? 1 : 2;
    const std::uint32_t w = c[(k + 1) % 3];
    if (!upwards_only || w > v) push(std::min(v, w), std::max(v, w));
  });
}

// Whether no triangle turns far.
bool Collapser::turns_little() const {
  for (std::size_t i = 0; i < change_.now.size(); ++i) {
    const LatticeTriangle& after = change_.shapes[i];
    const Vec3 x = to_double(mesh_.normal(change_.old[i]));
    const Vec3 y = to_double(exact_normal(after[0], after[1], after[2]));
    const double turn = dot(x, y), lengths = dot(x, x) * dot(y, y);
    if (lengths > 0 && (turn <= 0 || turn * turn < least_cosine * least_cosine * lengths))
      return false;
  }
  return true;
}

// An anchor keeps its normals, since others have them too. Whether the new triangles can be shaded by
// them: large ones show every degree.
bool Collapser::has_normals_for(std::uint32_t anchor) const {
  const auto* normals = mesh_.normals(anchor);
  if (normals == nullptr) return true;
  const double cell = parameters_.reach;
  return std::ranges::all_of(change_.shapes, [&](const LatticeTriangle& s) {
    const Vec3 n = to_double(exact_normal(s[0], s[1], s[2]));
    const double length = std::sqrt(dot(n, n));
    const double least =
        length > 2 * large_triangle * cell * cell ? flat_cosine : double{cluster_cosine};
    return dot(nearest_cluster(*normals, n, NormalSense::outward).of(*normals), n) >=
           least * length;
  });
}

void Collapser::set_normals(std::uint32_t u, std::uint32_t v, std::uint32_t keep,
                            const LatticePoint& at) {
  if (mesh_.normals(u) == nullptr || mesh_.freedom(keep) != Freedom::free) return;
  const Vec3 a = local(mesh_.position(u)), b = local(mesh_.position(v)), edge = b - a;
  const double part = std::clamp(dot(local(at) - a, edge) / dot(edge, edge), 0.05, 0.95);
  std::array<NormalSum, std::size_t{2} * max_clusters> sums{};
  std::size_t count = 0;
  const auto add = [&](std::uint32_t from, double weight) {
    for (const PackedNormal packed : *mesh_.normals(from)) {
      if (packed == no_normal) continue;
      const Vec3 n = unpack_normal(packed) * weight;
      sums[count++] = {static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z)};
    }
  };
  // What stands for much weighs more: small triangles along creases have the worst normals.
  const double near_u = (1 - part) * quadrics_[u].weight, near_v = part * quadrics_[v].weight;
  const double most = std::max(near_u, near_v);
  if (!(most > 0)) return;
  add(near_u >= near_v ? u : v, 1);
  add(near_u >= near_v ? v : u, std::min(near_u, near_v) / most);
  mesh_.set_normals(keep,
                    pack_clusters(cluster_normals({sums.data(), count}, NormalSense::outward)));
}

void Collapser::try_edge(std::uint32_t u, std::uint32_t v) {
  const std::uint32_t keep = keeper(u, v), gone = keep == u ? v : u;
  if (!moves_.linked(gone, keep)) return;
  const Candidates candidates_here = candidates(u, v);
  for (std::size_t i = 0; i < candidates_here.count; ++i) {
    const Candidate& place = candidates_here.places[i];
    if (place.cost > parameters_.tolerance) return;
    if (!moves_.collapse(gone, keep, place.at, change_) || !turns_little()) continue;
    if (mesh_.freedom(keep) != Freedom::free && !has_normals_for(keep)) continue;
    const EditMesh::Step step{keep, place.at, gone};
    if (!mesh_.keeps_samples(change_, step, parameters_.tolerance)) continue;
    if (parameters_.intersections != IntersectionRule::ignore && !mesh_.clean(change_)) continue;
    set_normals(gone, keep, keep, place.at);
    mesh_.apply(change_, step);
    quadrics_[keep] += quadrics_[gone];
    ++counts_.collapses;
    push_around(keep, false);
    return;
  }
}

}  // namespace

void collapse_edges(EditMesh& mesh, const RefineParameters& parameters, RefineCounts& counts) {
  Collapser(mesh, parameters, counts).run();
}

}  // namespace voxweld
