#include "stages/contouring/node_solver.h"

#include <cmath>

#include "stages/contouring/qef_normal.h"

namespace voxweld {

NodeSolver::NodeSolver(const ContourParameters& parameters)
    : parameters_(parameters), kernels_(qef_kernels()) {}

void NodeSolver::clear_planes() {
  planes_ = PlaneBatch{};
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
}

void NodeSolver::set_child(std::size_t lane, int octant, const Qef& child) {
  children_.octants |= 1u << octant;
  auto& slot = children_.child[static_cast<std::size_t>(octant)];
  for (std::size_t i = 0; i < 10; ++i) slot[i][lane] = child.r[i];
  for (std::size_t a = 0; a < 3; ++a) slot[10 + a][lane] = child.mass[a];
}

void NodeSolver::merge(int child_level) {
  merge_from(half_side(child_level));
}

void NodeSolver::merge_in_place() {
  merge_from({});
}

void NodeSolver::merge_from(Vec3 half) {
  if (parameters_.simplify.qef == QefForm::normal)
    merge_normal(children_, half, factors_);
  else
    kernels_.merge(children_, half, factors_);
}

void NodeSolver::load(std::size_t lane, const Qef& qef) {
  load_lane(qef, lane, factors_);
  if (parameters_.simplify.qef == QefForm::normal)
    factors_.planes[lane] = static_cast<double>(qef.r[0]) + static_cast<double>(qef.r[4]) +
                            static_cast<double>(qef.r[7]);
}

void NodeSolver::solve(int level, std::size_t count) {
  const Vec3 half =
      half_side(level) + parameters_.spacing * (level == 0 ? parameters_.simplify.overhang : 0);
  const double threshold = parameters_.simplify.singular_threshold;
  if (parameters_.simplify.qef == QefForm::normal) {
    solve_normal(factors_, centres_, half, threshold, solutions_);
    return;
  }
  kernels_.solve(factors_, threshold, solutions_);
  for (std::size_t lane = 0; lane < count; ++lane)
    constrain_lane(factors_, lane, half, threshold, solutions_);
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
