#include "stages/refine/repair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "stages/exact/orientation.h"
#include "stages/refine/edit_moves.h"
#include "stages/refine/known_hits.h"
#include "storage/types/brick_octree.h"

namespace voxweld {
namespace {

constexpr int most_rounds = 12;
constexpr std::size_t most_reaches = 8;

Vec3 to_double(const LatticePoint& p) {
  return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}
LatticePoint nearest_point(Vec3 p) {
  return {static_cast<std::int32_t>(std::floor(p.x + 0.5)),
          static_cast<std::int32_t>(std::floor(p.y + 0.5)),
          static_cast<std::int32_t>(std::floor(p.z + 0.5))};
}

class Repairer {
 public:
  Repairer(EditMesh& mesh, const RefineParameters& parameters, RefineCounts& counts,
           RepairEffort effort, double most)
      : mesh_(mesh),
        parameters_(parameters),
        counts_(counts),
        effort_(effort),
        most_(most),
        moves_(mesh),
        hits_(mesh),
        touched_(mesh.vertices()),
        failed_(mesh.triangles()) {}

  // All that is not around these was tried before.
  void know_all_but(std::span<const std::uint32_t> vertices) {
    std::ranges::fill(failed_, Failure{clock_, true});
    ++clock_;
    for (const std::uint32_t v : vertices) touched_[v] = clock_;
  }
  void run() {
    std::vector<std::uint32_t> bad = mesh_.intersecting();
    for (int round = 0; round < most_rounds && !bad.empty(); ++round) {
      bool any = false;
      for (const std::uint32_t t : bad)
        if (mesh_.alive(t)) any |= mend(t, round);
      if (!any && (anywhere_ || effort_ == RepairEffort::quick)) break;
      anywhere_ = !any;
      bad.insert(bad.end(), changed_.begin(), changed_.end());
      changed_.clear();
      bad = intersecting(bad);
    }
    mesh_.set_intersecting(std::move(bad));
  }

 private:
  struct Best {
    std::size_t fewer = 0;  // pairs that go
    Change change;
    EditMesh::Step step;
    bool enough = false;  // none is left there
    int kind = 0;         // 0 a move, 1 a flip, 2 a collapse
  };
  std::vector<std::uint32_t> intersecting(const std::vector<std::uint32_t>& among);
  void begin_reaches(int round);
  bool mend(std::uint32_t t, int round);
  // All that can be tried was, and nothing around has changed since.
  bool has_failed(std::uint32_t t, const std::vector<std::uint32_t>& vertices) const {
    const Failure& failure = failed_[t];
    return failure.anywhere >= anywhere_ && failure.clock != 0 &&
           std::ranges::all_of(vertices,
                               [&](std::uint32_t v) { return touched_[v] <= failure.clock; });
  }
  void try_moves(std::uint32_t v);
  void try_flips(std::uint32_t t);
  void try_collapse(std::uint32_t one, std::uint32_t other);
  void try_collapses(std::uint32_t t);
  bool is_done() const { return bests_[0].enough; }
  // change_: made by moves_.
  void consider(const EditMesh::Step& step, int kind);
  Vec3 along_surface(std::uint32_t v, Vec3 way) const;

  EditMesh& mesh_;
  const RefineParameters& parameters_;
  RefineCounts& counts_;
  RepairEffort effort_;
  const double most_;  // from a sample to its triangle
  EditMoves moves_;
  KnownHits hits_;
  // How far samples may go, each twice the one before. The least with which something helps counts, so
  // once that is found those beyond it are left out.
  std::array<double, most_reaches> reaches_{};
  std::size_t count_ = 0;  // of them
  bool anywhere_ = false;
  Change change_;
  std::array<Best, most_reaches> bests_;
  struct Known {
    std::vector<std::uint32_t> triangles;
    std::vector<std::uint32_t> others;  // that some of them intersect
    std::size_t hits = 0;
  };
  std::vector<Known> known_;
  std::vector<std::uint32_t> ring_;
  std::vector<std::uint32_t> changed_;  // triangles, in this round
  // When vertices were changed last, and of triangles when nothing helped.
  struct Failure {
    std::uint64_t clock = 0;
    bool anywhere = false;
  };
  std::uint64_t clock_ = 1;
  std::vector<std::uint64_t> touched_;
  std::vector<Failure> failed_;
};

// Of what was mended or changed, and of what lies around that. A bad triangle may be gone, and those
// that were changed with it may have come upon others.
std::vector<std::uint32_t> Repairer::intersecting(const std::vector<std::uint32_t>& among) {
  std::vector<std::uint32_t> near;
  for (const std::uint32_t t : among) {
    if (!mesh_.alive(t)) continue;
    for (const std::uint32_t v : mesh_.corners(t)) mesh_.star(v, near);
  }
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
  std::erase_if(near, [&](std::uint32_t t) { return !hits_.any(t); });
  return near;
}

// With the least reach that allows it.
void Repairer::consider(const EditMesh::Step& step, int kind) {
  const double most = reaches_[count_ - 1];
  const double reach = mesh_.squared_reach(change_, step, reaches_[0], most);
  if (reach > most * most) return;
  std::size_t least = 0;
  while (reach > reaches_[least] * reaches_[least]) ++least;
  Best& best = bests_[least];
  if (best.enough) return;
  auto known = std::ranges::find(known_, change_.old, &Known::triangles);
  if (known == known_.end()) {
    known = known_.insert(known, Known{change_.old, {}});
    known->hits = hits_.pairs_of(change_.old, known->others);
  }
  const std::size_t before = known->hits;
  if (before <= best.fewer) return;
  // What they intersect now they most likely still do, which mostly is enough to know.
  const std::size_t after = mesh_.hits(change_, before - best.fewer, known->others);
  if (after + best.fewer >= before) return;
  best = {before - after, change_, step, after == 0, kind};
  count_ = least + 1;
}

// What of `way` does not lead off the surface, as the vertex' normals have it.
Vec3 Repairer::along_surface(std::uint32_t v, Vec3 way) const {
  const auto* normals = mesh_.normals(v);
  if (normals == nullptr) return way;
  std::array<Vec3, 3> across{};
  std::size_t count = 0;
  for (const PackedNormal packed : *normals) {
    if (packed == no_normal) continue;
    Vec3 n = unpack_normal(packed);
    for (std::size_t i = 0; i < count; ++i) n = n - across[i] * dot(n, across[i]);
    const double length = std::sqrt(dot(n, n));
    if (length < 1e-3) continue;
    across[count] = n * (1 / length);
    way = way - across[count] * dot(way, across[count]);
    ++count;
  }
  return way;
}

void Repairer::try_moves(std::uint32_t v) {
  if (mesh_.freedom(v) != Freedom::free) return;
  moves_.ring(v, ring_);
  Vec3 sum{};
  for (const std::uint32_t w : ring_) sum = sum + to_double(mesh_.position(w));
  const Vec3 from = to_double(mesh_.position(v));
  const Vec3 way = sum * (1 / static_cast<double>(ring_.size())) - from;
  const Vec3 flat = along_surface(v, way);
  const auto consider_step = [&](Vec3 step) {
    const LatticePoint to = nearest_point(from + step);
    if (is_done() || to == mesh_.position(v) || !mesh_.box().contains(to)) return;
    if (!mesh_.keeps_border(v, to)) return;
    if (moves_.move(v, to, change_)) consider({v, to, EditMesh::none}, 0);
  };
  for (const Vec3& step : {flat * 0.25, flat * 0.5, flat, way * 0.25, way * 0.5, way})
    consider_step(step);
  if (!anywhere_) return;
  // Nothing that is likely has helped.
  for (const double length : {0.125, 0.25, 0.5, 1.0})
    each_index({splat(-1), splat(2)},
               [&](Index3 d) { consider_step(as_vec3(d) * (length * parameters_.reach)); });
}

void Repairer::try_flips(std::uint32_t t) {
  for (std::size_t k = 0; k < 3; ++k)
    if (moves_.flip(t, k, change_)) consider({}, 1);
}

void Repairer::try_collapse(std::uint32_t one, std::uint32_t other) {
  const auto ends = moves_.ends(one, other);
  if (!ends || !moves_.linked(ends->gone, ends->keep)) return;
  const auto [u, v, stays] = *ends;
  const LatticePoint a = mesh_.position(u), b = mesh_.position(v);
  const LatticePoint middle = nearest_point((to_double(a) + to_double(b)) * 0.5);
  for (const LatticePoint& at : {b, a, middle}) {
    if (is_done() || (at != b && stays)) return;
    if (!mesh_.keeps_border(v, at)) continue;
    if (moves_.collapse(u, v, at, change_)) consider({v, at, u}, 2);
  }
}

void Repairer::try_collapses(std::uint32_t t) {
  const Corners corners = mesh_.corners(t);
  for (std::size_t k = 0; k < 3; ++k) try_collapse(corners[k], corners[(k + 1) % 3]);
  if (!anywhere_) return;
  for (const std::uint32_t v : corners) {
    std::vector<std::uint32_t> ring;
    moves_.ring(v, ring);
    for (const std::uint32_t w : ring) try_collapse(v, w);
  }
}

// First what changes the surface least.
void Repairer::begin_reaches(int round) {
  const double last = parameters_.reach * (anywhere_ ? 4 : 1);
  double reach = std::min(parameters_.reach, std::ldexp(parameters_.reach / 16, round));
  count_ = 0;
  for (bool more = true; more; reach *= 2, ++count_) {
    more = reach < last;
    reaches_[count_] = std::min(reach, most_);
    bests_[count_].fewer = 0;
    bests_[count_].enough = false;
  }
}

bool Repairer::mend(std::uint32_t t, int round) {
  std::vector<std::uint32_t> pair{t};
  hits_.each(t, [&](std::uint32_t other) { pair.push_back(other); });
  if (pair.size() == 1) return false;
  std::sort(pair.begin() + 1, pair.end());
  std::vector<std::uint32_t> vertices;
  for (const std::uint32_t one : pair)
    vertices.insert(vertices.end(), mesh_.corners(one).begin(), mesh_.corners(one).end());
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  if (has_failed(t, vertices)) return false;
  known_.clear();
  begin_reaches(round);
  for (std::size_t i = 0; i < vertices.size() && !is_done(); ++i) try_moves(vertices[i]);
  for (const std::uint32_t one : pair)
    if (!is_done() && mesh_.movable(one)) {
      try_flips(one);
      try_collapses(one);
    }
  Best& best = bests_[count_ - 1];
  if (best.fewer == 0) {
    failed_[t] = {clock_, anywhere_};
    return false;
  }
  const auto kept = static_cast<std::ptrdiff_t>(best.change.now.size());
  changed_.insert(changed_.end(), best.change.old.begin(), best.change.old.begin() + kept);
  ++clock_;
  for (const Corners& c : best.change.now)
    for (const std::uint32_t v : c) touched_[v] = clock_;
  mesh_.keeps_samples(best.change, best.step, std::numeric_limits<double>::infinity());
  hits_.before(best.change);
  mesh_.apply(best.change, best.step);
  hits_.after(best.change);
  ++(best.kind == 0 ? counts_.moves : best.kind == 1 ? counts_.flips : counts_.collapses);
  return true;
}

}  // namespace

void repair_intersections(EditMesh& mesh, const RefineParameters& parameters, RefineCounts& counts,
                          RepairEffort effort, double most) {
  Repairer(mesh, parameters, counts, effort, most).run();
}

void repair_around(EditMesh& mesh, std::span<const std::uint32_t> changed,
                   const RefineParameters& parameters, RefineCounts& counts, RepairEffort effort) {
  Repairer repairer(mesh, parameters, counts, effort, std::numeric_limits<double>::infinity());
  repairer.know_all_but(changed);
  repairer.run();
}

}  // namespace voxweld
