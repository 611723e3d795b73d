// Random volumes, and the shapes of all nodes of their octrees, to judge clusters by.
#pragma once

#include <cmath>
#include <map>
#include <random>
#include <set>

#include "stages/contouring/node_shape.h"
#include "tests/support/reference_dual.h"

namespace voxweld::testing {

using Sheets = std::set<DualCorner>;

inline Index3 at(const DualCorner& sheet) {
  return {sheet.cell.x, sheet.cell.y, sheet.cell.z};
}
inline bool holds(CellKey node, const DualCorner& sheet) {
  return node.cells().contains(at(sheet));
}

inline SignGrid noise(std::int64_t side, unsigned seed, double share) {
  std::mt19937 random(seed);
  std::map<CellIndex, bool> inside;
  each_index(splat(side), [&](Index3 p) {
    inside[{p.z, p.y, p.x}] = static_cast<double>(random() % 1000) < share * 1000;
  });
  return {splat(side), [&](Index3 p) { return inside.at({p.z, p.y, p.x}); }};
}

inline SignGrid smooth(std::int64_t side, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  struct Wave {
    Vec3 way;
    double phase = 0, height = 0;
  };
  std::vector<Wave> waves(12);
  for (Wave& wave : waves)
    wave = {Vec3{unit(random), unit(random), unit(random)}, 3 * unit(random), unit(random)};
  return {
      splat(side), [&](Index3 p) {
        const Vec3 v{static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
        double sum = 0;
        for (const Wave& wave : waves) sum += wave.height * std::cos(dot(wave.way, v) + wave.phase);
        return sum > 0;
      }};
}

// A third of each: noise, sparse noise, smooth fields.
inline SignGrid volume(unsigned seed, std::int64_t side) {
  if (seed % 3 == 0) return noise(side, seed, 0.5);
  if (seed % 3 == 1) return noise(side, seed, 0.15);
  return smooth(side, seed);
}

struct ShapeNode {
  CellKey key;
  std::vector<std::int32_t> euler;
  std::vector<FaceCurve> curves;
  std::vector<CurvePair> pairs;
  std::vector<Sheets> clusters;  // that are open
  std::vector<bool> allowed;
  NodeShape shape() const { return {euler, curves, pairs}; }
};

// All nodes of a volume from the cells up; f takes each when its children were taken.
class ShapeTree {
 public:
  ShapeTree(const SignGrid& grid, const ReferenceDual& dual, const ClusterRules& rules)
      : grid_(grid), dual_(dual), rules_(rules) {}

  template <class F>
  void each(CellKey root, const F& f) {
    node(root, f);
  }

 private:
  CellSigns signs_of(Index3 cell) const {
    unsigned signs = 0;
    for (int corner = 0; corner < 8; ++corner)
      signs |= static_cast<unsigned>(
                   grid_.inside(cell + Index3{corner & 1, corner >> 1 & 1, corner >> 2}))
               << corner;
    return static_cast<CellSigns>(signs);
  }
  bool joined(Index3 cell) const {
    const int face = problem_face(signs_of(cell));
    if (face < 0) return false;
    Index3 across = cell;
    across[face >> 1] += (face & 1) != 0 ? 1 : -1;
    return joins_across(signs_of(cell), face, signs_of(across));
  }

  template <class F>
  std::vector<Sheets> node(CellKey key, const F& f, ShapeNode* out = nullptr) {
    if (intersect(key.cells(), grid_.cells()).empty()) return {};
    std::array<ShapeNode, 8> children;
    std::vector<Sheets> below;
    ShapeMerger merger(rules_);
    merger.begin(key);
    for (int o = 0; o < 8; ++o) {
      const CellKey child = key.child(o);
      if (child.level == 0) {
        const auto found = dual_.cells.find({child.at.z, child.at.y, child.at.x});
        if (found == dual_.cells.end()) continue;
        merger.add_cell(o, signs_of(child.at), joined(child.at));
        for (std::size_t p = 0; p < found->second.size(); ++p)
          below.push_back({{found->first, static_cast<int>(p)}});
        continue;
      }
      ShapeNode& made = children[static_cast<std::size_t>(o)];
      node(child, f, &made);
      if (made.curves.empty()) continue;
      merger.add(o, made.shape());
      below.insert(below.end(), made.clusters.begin(), made.clusters.end());
    }
    if (below.empty()) return {};
    merger.merge();
    ShapeNode mine;
    mine.key = key;
    const NodeShape shape = merger.shape();
    mine.euler.assign(shape.euler.begin(), shape.euler.end());
    mine.curves.assign(shape.curves.begin(), shape.curves.end());
    mine.pairs.assign(shape.pairs.begin(), shape.pairs.end());
    mine.clusters.resize(shape.euler.size());
    for (std::size_t i = 0; i < below.size(); ++i) {
      const std::uint32_t cluster = merger.cluster_of()[i];
      if (cluster != no_cluster) mine.clusters[cluster].insert(below[i].begin(), below[i].end());
    }
    for (std::size_t c = 0; c < mine.clusters.size(); ++c)
      mine.allowed.push_back(merger.may_collapse(c));
    f(mine);
    if (out != nullptr) *out = std::move(mine);
    return {};
  }

  const SignGrid& grid_;
  const ReferenceDual& dual_;
  ClusterRules rules_;
};

inline CellKey root_of(const SignGrid& grid) {
  return {domain_level(grid.size()), {}};
}

}  // namespace voxweld::testing
