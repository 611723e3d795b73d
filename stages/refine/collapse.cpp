#include "stages/refine/collapse.h"

#include <algorithm>
#include <cmath>

#include "stages/contouring/normal_clusters.h"
#include "stages/exact/orientation.h"
#include "stages/refine/edge_queue.h"
#include "stages/refine/edit_moves.h"
#include "stages/refine/quadric.h"
#include "stages/refine/rim_places.h"

namespace voxweld {
namespace {

constexpr double least_cosine = 0.3;  // of a triangle's turn in one collapse

constexpr double large_triangle = 16;  // cells
constexpr double flat_cosine = 0.995;  // of 6 degrees

// What an edge's squared length adds to its cost: of places that are equally flat the small ones go
// first, which keeps triangles in shape.
constexpr double shortest_first = 1e-6;

class Collapser {
 public:
  Collapser(EditMesh& mesh, const RefineParameters& parameters, CollapseCare care,
            RefineCounts& counts)
      : mesh_(mesh),
        parameters_(parameters),
        care_(care),
        counts_(counts),
        quadrics_(mesh.vertices()),
        moves_(mesh),
        rims_(mesh) {
    origin_ = mesh.box().lo;
    for (std::uint32_t t = 0; t < mesh.triangles(); ++t) add_plane(t);
  }

  // Again with a larger tolerance: what it would not let go before is looked at anew.
  void run(double tolerance) {
    tolerance_ = tolerance;
    for (std::uint32_t v = 0; v < mesh_.vertices(); ++v)
      if (!mesh_.gone(v)) push_around(v, true);
    QueuedEdge edge{};
    while (queue_.pop(edge))
      if (mesh_.version(edge.u) == edge.version_u && mesh_.version(edge.v) == edge.version_v)
        try_edge(edge.u, edge.v);
  }

 private:
  struct Candidate {
    double cost;  // mean squared distance
    LatticePoint at;
  };
  Vec3 local(const LatticePoint& p) const { return as_vec3(lattice_vector(origin_, p)); }
  std::int32_t to_grain(std::int32_t coordinate) const {
    return (coordinate + parameters_.grain / 2) & -parameters_.grain;
  }
  LatticePoint lattice(Vec3 p) const {
    LatticePoint q{};
    for (std::size_t a = 0; a < 3; ++a)
      q[a] = to_grain(static_cast<std::int32_t>(std::floor(p[static_cast<int>(a)] + 0.5)) +
                      origin_[a]);
    return q;
  }
  void add_plane(std::uint32_t t) {
    if (!mesh_.alive(t)) return;
    const LatticeTriangle s = mesh_.shape(t);
    const Vec3 n = as_vec3(mesh_.normal(t));
    const double length = std::sqrt(dot(n, n));
    if (!(length > 0)) return;
    const Vec3 unit = n * (1 / length);
    const Quadric q = Quadric::of_plane(unit, -dot(unit, local(s[0])), length);
    for (const std::uint32_t v : mesh_.corners(t)) quadrics_[v] += q;
    for (std::size_t k = 0; k < 3; ++k)
      add_rim(mesh_.corners(t)[k], mesh_.corners(t)[(k + 1) % 3], unit);
  }
  // Where the edge is one of an open border: a plane through it that stands on its triangle keeps the
  // border's line.
  void add_rim(std::uint32_t u, std::uint32_t v, Vec3 unit) {
    if (!is_rim(u) && !is_rim(v)) return;
    if (mesh_.around_edge(is_rim(u) ? u : v, is_rim(u) ? v : u) != 1) return;
    const Vec3 at = local(mesh_.position(u)), edge = local(mesh_.position(v)) - at;
    const Vec3 n = cross(edge, unit);
    const double length = std::sqrt(dot(n, n));
    if (!(length > 0)) return;
    const Quadric q = Quadric::of_plane(n * (1 / length), -dot(n, at) / length, length * length);
    for (const std::uint32_t end : {u, v})
      if (is_rim(end)) quadrics_[end] += q;
  }
  bool is_rim(std::uint32_t v) const { return mesh_.kind(v) == StarKind::rim; }
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
  Quadric quadric(const EdgeEnds& ends) const {
    Quadric q = quadrics_[ends.gone];
    q += quadrics_[ends.keep];
    return q;
  }
  bool is_too_far(double squared) const { return squared > tolerance_ * tolerance_; }
  Vec3 best_place(const Quadric& q, const EdgeEnds& ends) const;
  double least_cost(const Quadric& q, const EdgeEnds& ends) const;
  Candidates candidates(const EdgeEnds& ends) const;
  void push(std::uint32_t u, std::uint32_t v);
  void push_around(std::uint32_t v, bool upwards_only);
  void try_edge(std::uint32_t u, std::uint32_t v);
  bool turns_little() const;
  bool is_clean() {
    if (care_ == CollapseCare::none) return true;
    return care_ == CollapseCare::all ? mesh_.clean(change_) : mesh_.clean_around(change_);
  }
  bool has_normals_for(std::uint32_t anchor) const;
  void set_normals(std::uint32_t gone, std::uint32_t keep, const LatticePoint& at);

  EditMesh& mesh_;
  const RefineParameters& parameters_;
  const CollapseCare care_;
  RefineCounts& counts_;
  double tolerance_ = 0;
  LatticePoint origin_{};
  std::vector<Quadric> quadrics_;
  EdgeQueue queue_;
  EditMoves moves_;
  RimPlaces rims_;
  Change change_;
};

// Precondition: the end that is kept may move.
Vec3 Collapser::best_place(const Quadric& q, const EdgeEnds& ends) const {
  const Vec3 a = local(mesh_.position(ends.gone)), b = local(mesh_.position(ends.keep));
  const Vec3 middle = (a + b) * 0.5, best = q.minimiser(middle);
  // Where the planes are nearly parallel it may lie far off.
  const Vec3 way = best - middle, edge = b - a;
  return dot(way, way) > 4 * dot(edge, edge) ? middle : best;
}

Collapser::Candidates Collapser::candidates(const EdgeEnds& ends) const {
  Candidates out;
  const Quadric q = quadric(ends);
  const LatticePoint &a = mesh_.position(ends.gone), &b = mesh_.position(ends.keep);
  const auto add = [&](const LatticePoint& p) { out.add({q.squared_distance(local(p)), p}); };
  // A rim's vertices keep to places of the rim, or it would not end where it has to.
  if (is_rim(ends.gone)) {
    if (!ends.stays) add(a);
  } else if (!ends.stays) {
    const Vec3 middle = (local(a) + local(b)) * 0.5;
    for (const LatticePoint& p : {lattice(best_place(q, ends)), lattice(middle)})
      if (mesh_.box().contains(p)) add(p);
    add(a);
  }
  add(b);
  return out;
}

// Of the best place there is: a lattice point near it costs little more.
double Collapser::least_cost(const Quadric& q, const EdgeEnds& ends) const {
  const auto cost_at = [&](std::uint32_t v) {
    return q.squared_distance(local(mesh_.position(v)));
  };
  if (ends.stays) return cost_at(ends.keep);
  if (is_rim(ends.gone)) return std::min(cost_at(ends.keep), cost_at(ends.gone));
  return q.squared_distance(best_place(q, ends));
}

void Collapser::push(std::uint32_t u, std::uint32_t v) {
  const auto ends = moves_.ends(u, v);
  if (!ends) return;
  const Quadric q = quadric(*ends);
  const double cost = least_cost(q, *ends);
  if (is_too_far(cost)) return;
  const Vec3 edge = local(mesh_.position(ends->gone)) - local(mesh_.position(ends->keep));
  queue_.push(cost + shortest_first * dot(edge, edge), {u, v, mesh_.version(u), mesh_.version(v)});
}

void Collapser::push_around(std::uint32_t v, bool upwards_only) {
  if (mesh_.freedom(v) == Freedom::fixed) return;
  mesh_.each_around(v, [&](std::uint32_t t) {
    // Each edge of a ring has one triangle in which it comes after v.
    const Corners& c = mesh_.corners(t);
    const std::size_t k = corner_of(c, v);
    const std::uint32_t w = c[(k + 1) % 3], before = c[(k + 2) % 3];
    if (!upwards_only || w > v) push(std::min(v, w), std::max(v, w));
    // That by which a rim comes to v has only the one in which it comes before.
    if (is_rim(v) && (!upwards_only || before > v) && mesh_.around_edge(v, before) == 1)
      push(std::min(v, before), std::max(v, before));
  });
}

// Whether no triangle turns far.
bool Collapser::turns_little() const {
  for (std::size_t i = 0; i < change_.now.size(); ++i) {
    const Vec3 x = as_vec3(mesh_.normal(change_.old[i])), y = as_vec3(change_.planes[i]);
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
  return std::ranges::all_of(change_.planes, [&](const Index3& plane) {
    const Vec3 n = as_vec3(plane);
    const double length = std::sqrt(dot(n, n));
    const double least = length > 2 * large_triangle * cell * cell
                             ? flat_cosine
                             : double{parameters_.normals.cosine};
    return dot(nearest_cluster(*normals, n, mesh_.sense()).of(*normals), n) >= least * length;
  });
}

void Collapser::set_normals(std::uint32_t gone, std::uint32_t keep, const LatticePoint& at) {
  if (mesh_.normals(gone) == nullptr || mesh_.freedom(keep) != Freedom::free) return;
  const Vec3 a = local(mesh_.position(gone)), b = local(mesh_.position(keep)), edge = b - a;
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
  const double near_gone = (1 - part) * quadrics_[gone].weight,
               near_keep = part * quadrics_[keep].weight;
  const double most = std::max(near_gone, near_keep);
  if (!(most > 0)) return;
  add(near_gone >= near_keep ? gone : keep, 1);
  add(near_gone >= near_keep ? keep : gone, std::min(near_gone, near_keep) / most);
  mesh_.set_normals(keep, pack_clusters(cluster_normals({sums.data(), count}, mesh_.sense(),
                                                        parameters_.normals.cosine)));
}

void Collapser::try_edge(std::uint32_t u, std::uint32_t v) {
  const EdgeEnds ends = *moves_.ends(u, v);  // or it would not have been pushed
  const auto [gone, keep, stays] = ends;
  if (!moves_.linked(gone, keep)) return;
  const Candidates candidates_here = candidates(ends);
  for (std::size_t i = 0; i < candidates_here.count; ++i) {
    const Candidate& place = candidates_here.places[i];
    if (is_too_far(place.cost)) return;
    if (!moves_.collapse(gone, keep, place.at, change_) || !turns_little()) continue;
    if (mesh_.freedom(keep) != Freedom::free && !has_normals_for(keep)) continue;
    const EditMesh::Step step{keep, place.at, gone};
    if (!mesh_.keeps_samples(change_, step, tolerance_)) continue;
    if (is_rim(gone) && !rims_.keeps(gone, keep, place.at, tolerance_)) continue;
    if (!is_clean()) continue;
    if (is_rim(gone)) rims_.apply();
    set_normals(gone, keep, place.at);
    mesh_.apply(change_, step);
    quadrics_[keep] += quadrics_[gone];
    ++counts_.collapses;
    push_around(keep, false);
    return;
  }
}

}  // namespace

void collapse_edges(EditMesh& mesh, const RefineParameters& parameters, CollapseCare care,
                    RefineCounts& counts) {
  Collapser(mesh, parameters, care, counts).run(parameters.tolerance);
}

void collapse_by_steps(EditMesh& mesh, const RefineParameters& parameters,
                       std::span<const double> tolerances, CollapseCare care, RefineCounts& counts,
                       const std::function<void(std::size_t)>& after) {
  Collapser collapser(mesh, parameters, care, counts);
  for (std::size_t i = 0; i < tolerances.size(); ++i) {
    collapser.run(tolerances[i]);
    after(i);
  }
}

}  // namespace voxweld
