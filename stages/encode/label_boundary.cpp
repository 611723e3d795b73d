#include "stages/encode/label_boundary.h"

#include <map>
#include <utility>

namespace voxweld {
namespace {

// The triangles of each pair.
std::vector<std::vector<std::uint32_t>> by_pair(const TileMesh& mesh) {
  std::vector<std::vector<std::uint32_t>> triangles(mesh.pairs.size());
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i)
    triangles[mesh.triangle_pairs[i]].push_back(i);
  return triangles;
}

// Adds the triangles of one pair to one of its labels' boundary.
class BoundaryCounter {
 public:
  explicit BoundaryCounter(const TileMesh& mesh) : mesh_(mesh), seen_(mesh.positions.size()) {}

  void begin() { ++turn_; }
  void add(const std::vector<std::uint32_t>& triangles, bool outward, LabelBoundary& boundary) {
    corners_.clear();
    for (const std::uint32_t t : triangles) {
      auto corners = mesh_.triangles[t];
      if (!outward) std::swap(corners[1], corners[2]);
      corners_.push_back(corners);
      for (const std::uint32_t v : corners) {
        boundary.vertices += seen_[v] != turn_ ? 1 : 0;
        seen_[v] = turn_;
      }
    }
    boundary.triangles += triangles.size();
    boundary.measure += measure(mesh_.positions, corners_);
  }

 private:
  const TileMesh& mesh_;
  std::vector<std::uint32_t> seen_;  // in which turn
  std::uint32_t turn_ = 0;
  std::vector<std::array<std::uint32_t, 3>> corners_;
};

}  // namespace

std::vector<LabelBoundary> measure_labels(const TileMesh& mesh) {
  const auto triangles = by_pair(mesh);
  std::map<Material, std::vector<std::uint32_t>> pairs_of;
  for (std::uint32_t p = 0; p < mesh.pairs.size(); ++p) {
    pairs_of[mesh.pairs[p].inside].push_back(p);
    if (mesh.pairs[p].outside != exterior) pairs_of[mesh.pairs[p].outside].push_back(p);
  }
  BoundaryCounter counter(mesh);
  std::vector<LabelBoundary> boundaries;
  for (const auto& [label, pairs] : pairs_of) {
    counter.begin();
    LabelBoundary& boundary = boundaries.emplace_back();
    boundary.label = label;
    for (const std::uint32_t p : pairs)
      counter.add(triangles[p], mesh.pairs[p].inside == label, boundary);
  }
  return boundaries;
}

}  // namespace voxweld
