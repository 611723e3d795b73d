#include "stages/contouring/node_solver.h"

#include <algorithm>
#include <cmath>

#include "stages/contouring/qef_normal.h"

namespace voxweld {

NodeSolver::NodeSolver(const ContourParameters& parameters)
    : parameters_(parameters), kernels_(qef_kernels()) {}

void NodeSolver::clear_planes() {
  planes_ = PlaneBatch{};
  extents_ = {};
}

void NodeSolver::set_planes(std::size_t lane, const HermitePlane* planes, int count) {
  if (count > planes_.rows) planes_.rows = count;
  std::array<double, 3> sum{};
  for (int i = 0; i < count; ++i) {
    const HermitePlane& plane = planes[i];
    auto& row = planes_.plane[static_cast<std::size_t>(i)];
    double distance = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      row[a][lane] = plane.normal[a];
      distance += plane.normal[a] * plane.point[a];
      sum[a] += plane.point[a];
    }
    row[3][lane] = distance;
  }
  for (std::size_t a = 0; a < 3; ++a) planes_.mass[a][lane] = sum[a] / count;
}

void NodeSolver::reduce() {
  if (parameters_.simplify.qef == QefForm::normal)
    reduce_normal(planes_, centres_, factors_);
  else
    kernels_.reduce(planes_, factors_);
}

void NodeSolver::clear_children() {
  children_ = ChildBatch{};
  children_of_ = {};
}

void NodeSolver::set_child(std::size_t lane, int octant, const Qef& child) {
  children_.octants |= 1u << octant;
  auto& slot = children_.child[static_cast<std::size_t>(octant)];
  for (std::size_t i = 0; i < 10; ++i) slot[i][lane] = child.r[i];
  for (std::size_t a = 0; a < 3; ++a) slot[10 + a][lane] = child.mass[a];
  child_extents_[static_cast<std::size_t>(octant)][lane] = child.extent;
  children_of_[lane] = static_cast<std::uint8_t>(children_of_[lane] | 1u << octant);
}

void NodeSolver::merge(int child_level) {
  merge_from(half_side(child_level));
  join_extents(false);
}

void NodeSolver::merge_in_place() {
  merge_from({});
  join_extents(true);
}

void NodeSolver::join_extents(bool in_place) {
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    bool any = false;
    for (int octant = 0; octant < 8; ++octant) {
      if ((children_of_[lane] >> octant & 1) == 0) continue;
      const CellExtent& child = child_extents_[static_cast<std::size_t>(octant)][lane];
      const CellExtent part = in_place ? child : child.in_parent(octant);
      if (any)
        extents_[lane].join(part);
      else
        extents_[lane] = part;
      any = true;
    }
  }
}

void NodeSolver::merge_from(Vec3 half) {
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
LaneBox NodeSolver::box(int level, std::size_t lane) const {
  LaneBox box;
  const Vec3 half = half_side(level);
  for (int a = 0; a < 3; ++a) {
    const auto at = static_cast<std::size_t>(a);
    const double cell = parameters_.spacing[a];
    if (level == 0) {
      box.hi[at] = half[a] + cell * parameters_.simplify.overhang;
      box.lo[at] = -box.hi[at];
      continue;
    }
    const double unit = 2 * half[a] / 256;
    const CellExtent& extent = extents_[lane];
    box.lo[at] = std::max(-half[a], unit * extent.lo[at] - half[a] - cell);
    box.hi[at] = std::min(half[a], unit * (extent.hi[at] + 1) - half[a] + cell);
  }
  return box;
}

void NodeSolver::solve(int level, std::size_t count) {
  const double threshold = parameters_.simplify.singular_threshold;
  if (parameters_.simplify.qef == QefForm::normal) {
    std::array<LaneBox, lanes> boxes;
    for (std::size_t lane = 0; lane < lanes; ++lane) boxes[lane] = box(level, lane);
    solve_normal(factors_, centres_, boxes, threshold, solutions_);
    return;
  }
  kernels_.solve(factors_, threshold, solutions_);
  for (std::size_t lane = 0; lane < count; ++lane)
    constrain_lane(factors_, lane, box(level, lane), threshold, solutions_);
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
