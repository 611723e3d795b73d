// What is done to a mesh: stitch, refine, the lattice, Draco, exact tests.
#include <random>

#include "stages/encode/draco_codec.h"
#include "stages/exact/intersections.h"
#include "stages/refine/box_refiner.h"
#include "stages/refine/refine_cube.h"
#include "stages/refine/retile.h"
#include "stages/stitch/snap.h"
#include "tests/bench/kernels_support.h"

namespace voxweld::bench {
namespace {

// One cube of 64 cells in the middle, with what meets it.
struct Cube {
  static const Cube& get() {
    static const Cube cube;
    return cube;
  }
  LatticeBox box;
  RefineMesh mesh;
  std::size_t triangles = 0;  // that lie in it

 private:
  Cube() {
    const GyroidTile& tile = GyroidTile::get();
    const CubeLattice cubes(tile.frame, 0);
    box = cubes.box({1, 1, 1});
    const RefineMesh whole = to_refine_mesh(tile.mesh);
    MeshGather near;
    near.add(whole, [&](std::size_t t) { return whole.box(t).meets(box); });
    mesh = near.take();
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      if (lies_in(mesh, t, box)) ++triangles;
  }
};

// The dual walk: polygons of all bricks' edges become one mesh. Items are triangles.
void stitch_a_tile(benchmark::State& state) {
  const GyroidTile& tile = GyroidTile::get();
  while (state.KeepRunning()) benchmark::DoNotOptimize(tile.stitched());
  count(state, tile.mesh.triangles.size());
}
BENCHMARK(stitch_a_tile)->Unit(benchmark::kMillisecond);

// Edges of a cube collapsed, and what intersects mended: items are triangles as they come.
void refine_a_cube(benchmark::State& state) {
  const Cube& cube = Cube::get();
  const double step = GyroidTile::get().frame.lattice.step;
  RefineParameters parameters;
  parameters.mode = static_cast<RefineMode>(state.range(0));
  parameters.tolerance = 0.1 / step;
  parameters.reach = 1 / step;
  RefineCounts counts;
  while (state.KeepRunning()) {
    state.PauseTiming();
    RefineMesh mesh = cube.mesh;
    counts = {};
    state.ResumeTiming();
    refine_cube(mesh, cube.box, parameters, counts);
  }
  state.counters["collapses"] = static_cast<double>(counts.collapses);
  count(state, cube.triangles);
}
BENCHMARK(refine_a_cube)
    ->ArgName("mode")
    ->Arg(static_cast<int>(RefineMode::repair))
    ->Arg(static_cast<int>(RefineMode::collapse))
    ->Unit(benchmark::kMillisecond);

// Vertices onto the output lattice: items are vertices.
void quantize(benchmark::State& state) {
  const GyroidTile& tile = GyroidTile::get();
  const LatticeFrame frame{tile.frame.lattice, tile.frame.spacing, tile.frame.first};
  std::mt19937 random(1);
  std::uniform_real_distribution<float> inside(-0.5F, 0.5F);
  std::vector<std::array<float, 3>> offsets(4096);
  for (auto& offset : offsets) offset = {inside(random), inside(random), inside(random)};
  const CellKey leaf{0, {80, 70, 60}};
  while (state.KeepRunning())
    for (const auto& offset : offsets) benchmark::DoNotOptimize(snap_vertex(frame, leaf, offset));
  count(state, offsets.size());
}
BENCHMARK(quantize);

// Items are triangles, bytes those of the Draco buffer.
void draco_encode(benchmark::State& state) {
  const TileMesh& mesh = GyroidTile::get().mesh;
  EncodedMesh encoded;
  while (state.KeepRunning()) encoded = encode_draco(mesh, {});
  state.counters["bytes_a_triangle"] =
      static_cast<double>(encoded.bytes.size()) / static_cast<double>(encoded.triangles);
  count(state, mesh.triangles.size(), encoded.bytes.size());
}
BENCHMARK(draco_encode)->Unit(benchmark::kMillisecond);

void draco_decode(benchmark::State& state) {
  const EncodedMesh encoded = encode_draco(GyroidTile::get().mesh, {});
  while (state.KeepRunning()) benchmark::DoNotOptimize(decode_draco(encoded.bytes));
  count(state, encoded.triangles, encoded.bytes.size());
}
BENCHMARK(draco_decode)->Unit(benchmark::kMillisecond);

// Of one pair of triangles that lie near each other: items are pairs.
void exact_pair(benchmark::State& state) {
  const TileMesh& mesh = GyroidTile::get().mesh;
  const TriangleList triangles{mesh.positions, mesh.triangles};
  const std::size_t pairs = std::min<std::size_t>(4096, triangles.size() - 1);
  while (state.KeepRunning())
    for (std::size_t i = 0; i < pairs; ++i)
      benchmark::DoNotOptimize(intersect_beyond_shared(triangles[i], triangles[i + 1]));
  count(state, pairs);
}
BENCHMARK(exact_pair);

// All pairs of a mesh, with the tree that finds them: items are triangles.
void exact_mesh(benchmark::State& state) {
  const TileMesh& mesh = GyroidTile::get().mesh;
  std::size_t found = 0;
  while (state.KeepRunning()) {
    found = 0;
    each_intersection({mesh.positions, mesh.triangles},
                      [&](std::uint32_t, std::uint32_t) { ++found; });
  }
  state.counters["pairs"] = static_cast<double>(found);
  count(state, mesh.triangles.size());
}
BENCHMARK(exact_mesh)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace voxweld::bench
