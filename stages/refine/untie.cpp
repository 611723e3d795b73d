#include "stages/refine/untie.h"

#include <algorithm>

#include "stages/refine/edit_moves.h"
#include "stages/refine/repair.h"

namespace voxweld {
namespace {

constexpr std::size_t most_pairs = 4;

struct Trial {
  Change change;
  EditMesh::Step step;
};

class Untier {
 public:
  Untier(EditMesh& mesh, const RefineParameters& parameters, RefineCounts& counts)
      : mesh_(mesh), parameters_(parameters), counts_(counts) {}

  // Whether fewer pairs are left now.
  bool untie(std::uint32_t t);

 private:
  std::vector<std::uint32_t> vertices_around(std::uint32_t t) const;
  bool try_changes_of(std::uint32_t t);
  bool try_moves(std::uint32_t v, double length);
  bool attempt(const Trial& trial, std::uint64_t RefineCounts::*kind);

  EditMesh& mesh_;
  const RefineParameters& parameters_;
  RefineCounts& counts_;
  std::size_t pairs_ = 0;
  RepairEffort effort_ = RepairEffort::quick;  // of trials
};

// Of it and of what it intersects.
std::vector<std::uint32_t> Untier::vertices_around(std::uint32_t t) const {
  std::vector<std::uint32_t> vertices;
  const auto add = [&](std::uint32_t one) {
    vertices.insert(vertices.end(), mesh_.corners(one).begin(), mesh_.corners(one).end());
  };
  add(t);
  mesh_.each_hit(t, add);
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

// Most that can be untied is so by a flip or a collapse, and what is left to repair then is seldom hard.
bool Untier::untie(std::uint32_t t) {
  pairs_ = mesh_.count_pairs();
  effort_ = RepairEffort::quick;
  if (try_changes_of(t)) return true;
  const std::vector<std::uint32_t> vertices = vertices_around(t);
  for (const double length : {0.125, 0.25, 1.0})
    for (const std::uint32_t v : vertices)
      if (try_moves(v, length * parameters_.reach)) return true;
  effort_ = RepairEffort::thorough;
  return try_changes_of(t);
}

// Flips of the edges of t and of what it intersects, and their collapses.
bool Untier::try_changes_of(std::uint32_t t) {
  std::vector<std::uint32_t> triangles{t};
  mesh_.each_hit(t, [&](std::uint32_t other) { triangles.push_back(other); });
  std::sort(triangles.begin(), triangles.end());
  EditMoves moves(mesh_);
  Trial trial;
  for (const std::uint32_t one : triangles) {
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
  std::vector<std::uint32_t> bad = mesh_.intersecting();
  const auto kept = static_cast<std::ptrdiff_t>(trial.change.now.size());
  bad.insert(bad.end(), trial.change.old.begin(), trial.change.old.begin() + kept);
  std::sort(bad.begin(), bad.end());
  bad.erase(std::unique(bad.begin(), bad.end()), bad.end());
  copy.set_intersecting(std::move(bad));
  copy.recheck_intersecting();
  RefineCounts counts;
  repair_intersections(copy, parameters_, counts, effort_);
  if (copy.count_pairs() >= pairs_) return false;
  mesh_ = std::move(copy);
  counts_.add(counts);
  ++(counts_.*kind);
  return true;
}

}  // namespace

void untie_intersections(EditMesh& mesh, const RefineParameters& parameters, RefineCounts& counts) {
  std::vector<std::uint32_t> tied;  // nothing helps with them
  for (std::size_t i = 0; i < most_pairs;) {
    const auto& bad = mesh.intersecting();
    const auto next = std::ranges::find_if(bad, [&](std::uint32_t t) {
      return mesh.movable(t) && std::ranges::find(tied, t) == tied.end();
    });
    if (next == bad.end()) return;
    const std::uint32_t t = *next;
    if (Untier(mesh, parameters, counts).untie(t)) continue;
    tied.push_back(t);
    ++i;
  }
}

}  // namespace voxweld
