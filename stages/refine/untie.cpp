#include "stages/refine/untie.h"

#include <algorithm>

#include "stages/refine/edit_moves.h"
#include "stages/refine/repair.h"

namespace voxweld {
namespace {

constexpr std::size_t most_failures = 4;
constexpr std::size_t most_in_knot = 32;

// All that hang together, or some around the triangle where these are many; ascending.
std::vector<std::uint32_t> knot_around(EditMesh& mesh, std::uint32_t t) {
  std::vector<std::uint32_t> knot{t};
  for (std::size_t i = 0; i < knot.size() && knot.size() < most_in_knot; ++i) {
    const auto known = static_cast<std::ptrdiff_t>(knot.size());
    mesh.each_hit(knot[i], [&](std::uint32_t other) {
      if (std::ranges::find(knot, other) == knot.end()) knot.push_back(other);
    });
    // Which these are may not depend on where the search comes upon them.
    std::sort(knot.begin() + known, knot.end());
  }
  std::sort(knot.begin(), knot.end());
  return knot;
}

Knot ids_of(const EditMesh& mesh, const std::vector<std::uint32_t>& triangles) {
  Knot knot;
  for (const std::uint32_t t : triangles) {
    const Corners& c = mesh.corners(t);
    knot.push_back({mesh.id(c[0]), mesh.id(c[1]), mesh.id(c[2])});
    std::sort(knot.back().begin(), knot.back().end());
  }
  std::sort(knot.begin(), knot.end());
  return knot;
}

struct Trial {
  Change change;
  EditMesh::Step step;
};

class Untier {
 public:
  Untier(EditMesh& mesh, const std::vector<std::uint32_t>& knot, const RefineParameters& parameters,
         RefineCounts& counts)
      : mesh_(mesh), knot_(knot), parameters_(parameters), counts_(counts) {}

  // Whether fewer pairs are left now.
  bool untie();

 private:
  std::vector<std::uint32_t> vertices() const;
  bool try_changes();
  bool try_moves(std::uint32_t v, double length);
  bool attempt(const Trial& trial, std::uint64_t RefineCounts::*kind);

  EditMesh& mesh_;
  const std::vector<std::uint32_t>& knot_;
  const RefineParameters& parameters_;
  RefineCounts& counts_;
  std::size_t pairs_ = 0;
  RepairEffort effort_ = RepairEffort::quick;  // of trials
};

std::vector<std::uint32_t> Untier::vertices() const {
  std::vector<std::uint32_t> vertices;
  for (const std::uint32_t t : knot_)
    vertices.insert(vertices.end(), mesh_.corners(t).begin(), mesh_.corners(t).end());
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

// Most that can be untied is so by a flip or a collapse, and what is left to repair then is seldom hard.
bool Untier::untie() {
  pairs_ = mesh_.count_pairs();
  effort_ = RepairEffort::quick;
  if (try_changes()) return true;
  const std::vector<std::uint32_t> around = vertices();
  for (const double length : {0.125, 0.25, 1.0})
    for (const std::uint32_t v : around)
      if (try_moves(v, length * parameters_.reach)) return true;
  effort_ = RepairEffort::thorough;
  return try_changes();
}

// Flips of their edges, and collapses.
bool Untier::try_changes() {
  EditMoves moves(mesh_);
  Trial trial;
  for (const std::uint32_t one : knot_) {
    if (!mesh_.movable(one)) continue;
    const Corners corners = mesh_.corners(one);
    for (std::size_t k = 0; k < 3; ++k) {
      trial.step = {};
      if (moves.flip(one, k, trial.change) && attempt(trial, &RefineCounts::flips)) return true;
      const auto ends = moves.ends(corners[k], corners[(k + 1) % 3]);
      if (!ends || !moves.linked(ends->gone, ends->keep)) continue;
      const LatticePoint at = mesh_.position(ends->keep);
      trial.step = {ends->keep, at, ends->gone};
      if (moves.collapse(ends->gone, ends->keep, at, trial.change) &&
          attempt(trial, &RefineCounts::collapses))
        return true;
    }
  }
  return false;
}

bool Untier::try_moves(std::uint32_t v, double length) {
  if (mesh_.freedom(v) != Freedom::free) return false;
  EditMoves moves(mesh_);
  Trial trial;
  const auto step = static_cast<std::int32_t>(length);
  const LatticePoint from = mesh_.position(v);
  bool untied = false;
  each_index({splat(-1), splat(2)}, [&](Index3 d) {
    if (untied || d == Index3{}) return;
    const LatticePoint to{from[0] + static_cast<std::int32_t>(d.x) * step,
                          from[1] + static_cast<std::int32_t>(d.y) * step,
                          from[2] + static_cast<std::int32_t>(d.z) * step};
    if (!mesh_.box().contains(to) || !mesh_.keeps_border(v, to)) return;
    if (!moves.move(v, to, trial.change)) return;
    trial.step = {v, to, EditMesh::none};
    untied = attempt(trial, &RefineCounts::moves);
  });
  return untied;
}

bool Untier::attempt(const Trial& trial, std::uint64_t RefineCounts::*kind) {
  EditMesh copy = mesh_;
  if (!copy.keeps_samples(trial.change, trial.step, 2 * parameters_.reach)) return false;
  copy.apply(trial.change, trial.step);
  // What else intersects has been repaired as far as that goes.
  std::vector<std::uint32_t> bad = knot_;
  const auto kept = static_cast<std::ptrdiff_t>(trial.change.now.size());
  bad.insert(bad.end(), trial.change.old.begin(), trial.change.old.begin() + kept);
  std::sort(bad.begin(), bad.end());
  bad.erase(std::unique(bad.begin(), bad.end()), bad.end());
  copy.set_intersecting(std::move(bad));
  copy.recheck_intersecting();
  std::vector<std::uint32_t> changed;
  for (const Corners& corners : trial.change.now)
    changed.insert(changed.end(), corners.begin(), corners.end());
  RefineCounts counts;
  repair_around(copy, changed, parameters_, counts, effort_);
  copy.add_intersecting(mesh_.intersecting());
  if (copy.count_pairs() >= pairs_) return false;
  mesh_ = std::move(copy);
  counts_.add(counts);
  ++(counts_.*kind);
  return true;
}

}  // namespace

void untie_intersections(EditMesh& mesh, const RefineParameters& parameters, std::set<Knot>& tied,
                         RefineCounts& counts) {
  std::vector<std::uint32_t> done;  // that are tied
  for (std::size_t failures = 0; failures < most_failures;) {
    const auto& bad = mesh.intersecting();
    const auto next = std::ranges::find_if(bad, [&](std::uint32_t t) {
      return mesh.movable(t) && std::ranges::find(done, t) == done.end();
    });
    if (next == bad.end()) return;
    const std::vector<std::uint32_t> knot = knot_around(mesh, *next);
    Knot ids = ids_of(mesh, knot);
    if (!tied.contains(ids)) {
      if (Untier(mesh, knot, parameters, counts).untie()) continue;
      tied.insert(std::move(ids));
      ++failures;
    }
    done.insert(done.end(), knot.begin(), knot.end());
  }
}

}  // namespace voxweld
