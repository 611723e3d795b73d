// Build, from samples to an octree: one brick of 64 cells a side.
#include "stages/build/active_cells.h"
#include "stages/build/cut_brick.h"
#include "stages/build/hermite.h"
#include "tests/bench/kernels_support.h"

namespace voxweld::bench {
namespace {

SignGrid signs_of(const GyroidBrick& brick) {
  SignGrid signs;
  signs.fill(brick.block, brick.place.origin, brick.side, brick.parameters.surface);
  return signs;
}

// Which samples are inside: items are samples.
void sign_scan(benchmark::State& state) {
  const GyroidBrick& brick = GyroidBrick::get();
  SignGrid signs;
  while (state.KeepRunning())
    signs.fill(brick.block, brick.place.origin, brick.side, brick.parameters.surface);
  const auto points = static_cast<std::size_t>(brick.side) + 3;
  count(state, points * points * points, 2 * points * points * points);
}
BENCHMARK(sign_scan);

// Which cells the surface crosses: items are all cells.
void crossing_scan(benchmark::State& state) {
  const GyroidBrick& brick = GyroidBrick::get();
  const SignGrid signs = signs_of(brick);
  ActiveCells cells;
  while (state.KeepRunning()) {
    cells.count(signs, brick.side, Box3{splat(-1), splat(brick.side + 1)});
    cells.find(signs);
  }
  state.counters["active"] = static_cast<double>(cells.size());
  const auto side = static_cast<std::size_t>(brick.side) + 2;
  count(state, side * side * side);
}
BENCHMARK(crossing_scan);

// Crossings and normals: items are edges.
void hermite_edges(benchmark::State& state) {
  const GyroidBrick& brick = GyroidBrick::get();
  ContourParameters parameters = brick.parameters;
  parameters.surface.gradient = static_cast<Gradient>(state.range(0));
  const SignGrid signs = signs_of(brick);
  HermiteEdges edges;
  while (state.KeepRunning())
    edges.compute(brick.block, brick.place.origin, brick.side, signs, parameters);
  count(state, edges.size());
}
BENCHMARK(hermite_edges)
    ->ArgName("gradient")
    ->Arg(static_cast<int>(Gradient::eno))
    ->Arg(static_cast<int>(Gradient::central))
    ->Arg(static_cast<int>(Gradient::subcell));

// All of it: items are active cells.
void whole_brick(benchmark::State& state) {
  const GyroidBrick& brick = GyroidBrick::get();
  BrickScratch scratch;
  BrickOctree octree;
  while (state.KeepRunning())
    build_brick(brick.block, brick.place, brick.parameters, scratch, octree);
  const SignGrid signs = signs_of(brick);
  ActiveCells cells;
  count(state, cells.count(signs, brick.side, Box3{{}, splat(brick.side)}));
}
BENCHMARK(whole_brick)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace voxweld::bench
