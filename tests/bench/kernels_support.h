// What the kernels' benchmarks work on: a piece of the gyroid, as the program meets it.
#pragma once

#include <benchmark/benchmark.h>

#include <vector>

#include "pipeline/phantom/phantom_source.h"
#include "stages/build/build_brick.h"
#include "stages/refine/cube_lattice.h"
#include "stages/whole/contour_volume.h"

namespace voxweld::bench {

// A gyroid of so many samples a side; its tubes are a tenth of that wide. Inside: below 32767.5.
struct GyroidVolume {
  explicit GyroidVolume(std::int64_t samples_a_side)
      : size(splat(samples_a_side)),
        samples(static_cast<std::size_t>(samples_a_side * samples_a_side * samples_a_side) * 2) {
    const PhantomSource source({PhantomKind::gyroid, samples_a_side});
    source.read({{}, size}, samples.data());
  }
  operator VolumeSamples() const { return {SampleType::u16, size, samples}; }

  Index3 size;
  std::vector<std::byte> samples;
};

inline ContourParameters gyroid_parameters() {
  ContourParameters parameters;
  parameters.surface.isovalue = {32767.5};
  parameters.surface.inside = Inside::below;
  parameters.surface.gradient = Gradient::subcell;
  return parameters;
}

// A brick of 64 cells in the middle of a gyroid of 256 samples, so that most of it is as in a large
// volume. Made once.
struct GyroidBrick {
  static const GyroidBrick& get() {
    static const GyroidBrick brick;
    return brick;
  }

  GyroidVolume volume{256};
  BrickPlace place{{128, 64, 128}, 6};
  int side = 64;
  ContourParameters parameters = gyroid_parameters();
  HaloBlock block{SampleType::u16,       volume.size,   {{}, volume.size},
                  volume.samples.data(), volume.size.x, volume.size.x* volume.size.y};
};

// One tile: the surface of a gyroid of 160 samples, before refine, and the octrees that it is stitched of. Made once.
struct GyroidTile {
  static const GyroidTile& get() {
    static const GyroidTile tile;
    return tile;
  }

  TileMesh stitched() const { return stitch_tile(bricks, plan, plan.plan.at(0)); }

  VolumeBricks bricks;
  VolumeContour plan;
  TileMesh mesh;
  RefineFrame frame;

 private:
  GyroidTile();
};

// Items and, where there are any, bytes of one iteration.
inline void count(benchmark::State& state, std::size_t items, std::size_t bytes = 0) {
  const auto rounds = state.iterations();
  state.SetItemsProcessed(rounds * static_cast<std::int64_t>(items));
  if (bytes > 0) state.SetBytesProcessed(rounds * static_cast<std::int64_t>(bytes));
}

}  // namespace voxweld::bench
