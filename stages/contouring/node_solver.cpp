#include "stages/contouring/node_solver.h"

#include <algorithm>
#include <cmath>

#include "stages/contouring/qef_normal.h"

namespace voxweld {

NodeSolver::NodeSolver(const ContourParameters& parameters)
    : parameters_(parameters), kernels_(qef_kernels()) {}

void NodeSolver::clear_planes() {
  planes_.rows = 0;
  for (std::size_t i = 0; i < 3; ++i) planes_.plane[i] = {};
  planes_.mass = {};
  extents_ = {};
}

void NodeSolver::set_planes(std::size_t lane, std::span<const HermitePlane> planes) {
  static constexpr std::array<double, 5> roots = {0, 1, 1.4142135623730951, 0, 2};
  for (; planes_.rows < static_cast<int>(planes.size()); ++planes_.rows)
    if (planes_.rows >= 3) planes_.plane[static_cast<std::size_t>(planes_.rows)] = {};
  std::array<double, 3> sum{};
  double total = 0;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const HermitePlane& plane = planes[i];
    const double weight = plane.weight, root = roots[static_cast<std::size_t>(plane.weight)];
    auto& row = planes_.plane[i];
    double distance = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      row[a][lane] = root * plane.normal[a];
      distance += plane.normal[a] * plane.point[a];
      sum[a] += weight * plane.point[a];
    }
    row[3][lane] = root * distance;
    total += weight;
  }
  for (std::size_t a = 0; a < 3; ++a) planes_.mass[a][lane] = sum[a] / total;
}

void NodeSolver::reduce() {
  if (parameters_.simplify.qef == QefForm::normal)
    reduce_normal(planes_, centres_, factors_);
  else
    kernels_.reduce(planes_, factors_);
}

void NodeSolver::clear_children() {
  children_.slots = 0;
  children_.child[0] = {};
  of_children_.fill(CellExtent::none());
  children_set_ = {};
}

ChildValues& NodeSolver::put(std::size_t lane, const Qef& qef) {
  const std::size_t slot = children_set_[lane]++;
  ChildValues& into = children_.child[slot];
  if (slot == children_.slots) {
    if (slot > 0) into = {};
    ++children_.slots;
  }
  for (std::size_t i = 0; i < 10; ++i) into[i][lane] = qef.r[i];
  for (std::size_t a = 0; a < 3; ++a) into[10 + a][lane] = qef.mass[a];
  return into;
}

void NodeSolver::set_child(std::size_t lane, int octant, const Qef& child) {
  ChildValues& values = put(lane, child);
  for (std::size_t a = 0; a < 3; ++a) values[13 + a][lane] = (octant >> a & 1) != 0 ? 1.0F : -1.0F;
  of_children_[lane].join(child.extent.in_parent(octant));
}

void NodeSolver::set_part(std::size_t lane, const Qef& part) {
  put(lane, part);
  of_children_[lane].join(part.extent);
}

void NodeSolver::merge(int child_level) {
  merge_from(half_side(child_level));
}

void NodeSolver::merge_in_place() {
  merge_from({});
}

void NodeSolver::merge_from(Vec3 half) {
  extents_ = of_children_;
  if (parameters_.simplify.qef == QefForm::normal)
    merge_normal(children_, half, factors_);
  else
    kernels_.merge(children_, half, factors_);
}

void NodeSolver::load(std::size_t lane, const Qef& qef) {
  load_lane(qef, lane, factors_);
  extents_[lane] = qef.extent;
  if (parameters_.simplify.qef == QefForm::normal)
    factors_.planes[lane] = static_cast<double>(qef.r[0]) + static_cast<double>(qef.r[4]) +
                            static_cast<double>(qef.r[7]);
}

// Few planes of a noisy place may meet far away, all the more so where a node has many cells and the
// sheet is in few of them.
void NodeSolver::find_boxes(int level) {
  if (level == 0 && boxes_are_of_cells_) return;
  boxes_are_of_cells_ = level == 0;
  const Vec3 half = half_side(level);
  for (int a = 0; a < 3; ++a) {
    const auto at = static_cast<std::size_t>(a);
    const double cell = parameters_.spacing[a], h = half[a];
    if (level == 0) {
      const double end = h + cell * parameters_.simplify.overhang;
      for (LaneBox& box : boxes_) {
        box.lo[at] = -end;
        box.hi[at] = end;
      }
      continue;
    }
    const double unit = 2 * h / 256, below = h + cell, above = unit - h + cell;
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      boxes_[lane].lo[at] = std::max(-h, unit * extents_[lane].lo[at] - below);
      boxes_[lane].hi[at] = std::min(h, unit * extents_[lane].hi[at] + above);
    }
  }
}

void NodeSolver::solve(int level, std::size_t count) {
  const double threshold = parameters_.simplify.singular_threshold;
  find_boxes(level);
  if (parameters_.simplify.qef == QefForm::normal)
    return solve_normal(factors_, centres_, boxes_, threshold, solutions_);
  kernels_.solve(factors_, threshold, solutions_);
  for (std::size_t lane = 0; lane < count; ++lane)
    constrain_lane(factors_, lane, boxes_[lane], threshold, solutions_);
}

NodeSolution NodeSolver::solution(std::size_t lane) const {
  NodeSolution solution;
  for (std::size_t a = 0; a < 3; ++a)
    solution.offset[a] = static_cast<float>(solutions_.x[a][lane]);
  const double planes = factors_.planes[lane];
  const double energy = parameters_.simplify.metric == Metric::rms && planes > 0
                            ? solutions_.energy[lane] / planes
                            : solutions_.energy[lane];
  solution.residual = static_cast<float>(std::sqrt(energy));
  return solution;
}

}  // namespace voxweld
