#include "stages/refine/rim_places.h"

#include <algorithm>

#include "stages/exact/orientation.h"

namespace voxweld {
namespace {

double squared_distance(const LatticePoint& p, const LatticePoint& a, const LatticePoint& b) {
  const Vec3 ab = as_vec3(lattice_vector(a, b)), ap = as_vec3(lattice_vector(a, p));
  const double length = dot(ab, ab);
  const Vec3 off = length > 0 ? ap - ab * std::clamp(dot(ap, ab) / length, 0.0, 1.0) : ap;
  return dot(off, off);
}

}  // namespace

// The next vertex of the rim, or the one before v; none where v itself is of another kind.
std::uint32_t RimPlaces::neighbour(std::uint32_t v, Way way) const {
  std::uint32_t found = EditMesh::none;
  if (mesh_.kind(v) != StarKind::rim) return found;
  const std::size_t step = way == Way::forwards ? 1 : 2;  // as triangles at the rim run
  mesh_.each_around(v, [&](std::uint32_t t) {
    const Corners& c = mesh_.corners(t);
    const std::uint32_t w = c[(corner_of(c, v) + step) % 3];
    if (mesh_.around_edge(v, w) == 1) found = w;
  });
  return found;
}

void RimPlaces::take(std::uint32_t from, std::uint32_t to) {
  if (from == EditMesh::none || to == EditMesh::none) return;
  old_.push_back(std::uint64_t{from} << 32 | to);
  const auto known = places_.find(old_.back());
  if (known != places_.end())
    taken_.insert(taken_.end(), known->second.begin(), known->second.end());
}

bool RimPlaces::keeps(std::uint32_t gone, std::uint32_t keep, const LatticePoint& at, double most) {
  const bool forwards = neighbour(gone, Way::forwards) == keep;
  const std::uint32_t first = forwards ? gone : keep, second = forwards ? keep : gone;
  const std::uint32_t from = neighbour(first, Way::backwards),
                      to = neighbour(second, Way::forwards);
  taken_.clear();
  old_.clear();
  take(from, first);
  take(first, second);
  take(second, to);
  for (const std::uint32_t v : {first, second})
    if (mesh_.position(v) != at) taken_.push_back(mesh_.position(v));
  now_ = {};
  if (from != EditMesh::none) now_[0] = {from, keep, mesh_.position(from), at, {}};
  if (to != EditMesh::none) now_[1] = {keep, to, at, mesh_.position(to), {}};
  for (const LatticePoint& place : taken_) {
    Edge* nearest = nullptr;
    double least = most * most;
    for (Edge& edge : now_) {
      if (!edge.is_there()) continue;
      const double squared = squared_distance(place, edge.a, edge.b);
      if (squared > least || (nearest != nullptr && squared == least)) continue;
      nearest = &edge;
      least = squared;
    }
    if (nearest == nullptr) return false;
    nearest->places.push_back(place);
  }
  return true;
}

void RimPlaces::apply() {
  for (const std::uint64_t key : old_) places_.erase(key);
  for (Edge& edge : now_)
    if (edge.is_there() && !edge.places.empty()) places_[edge.key()] = std::move(edge.places);
}

}  // namespace voxweld
