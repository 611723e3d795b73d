// QEFs, eight nodes at a time: items are nodes.
#include <algorithm>
#include <cmath>
#include <random>

#include "stages/contouring/node_solver.h"
#include "tests/bench/kernels_support.h"

namespace voxweld::bench {
namespace {

constexpr int planes_of_cell = 6;  // about as many as a cell of a smooth surface has

// Planes near a common one, as those of a smooth surface.
std::vector<HermitePlane> random_planes(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const std::array<double, 3> main{unit(random), unit(random), unit(random)};
  std::vector<HermitePlane> planes(planes_of_cell);
  for (HermitePlane& plane : planes) {
    double squares = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      plane.normal[a] = main[a] + 0.2 * unit(random);
      plane.point[a] = 0.5 * unit(random);
      squares += plane.normal[a] * plane.normal[a];
    }
    for (double& n : plane.normal) n /= std::sqrt(squares);
  }
  return planes;
}

class Nodes {
 public:
  Nodes() : solver_(gyroid_parameters()) {
    std::mt19937 random(1);
    for (auto& planes : planes_) planes = random_planes(random);
  }
  NodeSolver& solver() { return solver_; }

  void insert() {
    solver_.clear_planes();
    for (std::size_t lane = 0; lane < lanes; ++lane)
      solver_.set_planes(lane, {planes_[lane].data(), planes_of_cell});
    solver_.reduce();
  }
  // Children of a surface through the node: half of them have some of it.
  void set_children() {
    for (std::size_t lane = 0; lane < lanes; ++lane) children_[lane] = solver_.qef(lane);
  }
  void merge(int child_level) {
    solver_.clear_children();
    for (std::size_t lane = 0; lane < lanes; ++lane)
      for (int octant = 0; octant < 8; octant += 2)
        solver_.set_child(lane, octant, children_[lane]);
    solver_.merge(child_level);
  }

 private:
  NodeSolver solver_;
  std::array<std::vector<HermitePlane>, lanes> planes_;
  std::array<Qef, lanes> children_;
};

void qr_insert(benchmark::State& state) {
  Nodes nodes;
  while (state.KeepRunning()) nodes.insert();
  count(state, lanes);
}
BENCHMARK(qr_insert);

void qr_merge(benchmark::State& state) {
  Nodes nodes;
  nodes.insert();
  nodes.set_children();
  while (state.KeepRunning()) nodes.merge(0);
  count(state, lanes);
}
BENCHMARK(qr_merge);

void qef_solve(benchmark::State& state) {
  Nodes nodes;
  nodes.insert();
  while (state.KeepRunning()) {
    nodes.solver().solve(0, lanes);
    benchmark::DoNotOptimize(nodes.solver().solution(0));
  }
  count(state, lanes);
}
BENCHMARK(qef_solve);

// What is done for each node of a level: its children are merged, its vertex is found, and it is held
// against the tolerance.
void collapse_level(benchmark::State& state) {
  const int child_level = static_cast<int>(state.range(0));
  Nodes nodes;
  nodes.insert();
  nodes.set_children();
  while (state.KeepRunning()) {
    nodes.merge(child_level);
    nodes.solver().solve(child_level + 1, lanes);
    for (std::size_t lane = 0; lane < lanes; ++lane)
      benchmark::DoNotOptimize(nodes.solver().within_tolerance(nodes.solver().solution(lane)));
  }
  count(state, lanes);
}
BENCHMARK(collapse_level)->ArgName("level")->Arg(0)->Arg(2);

}  // namespace
}  // namespace voxweld::bench
