#include "tests/bench/kernels_support.h"

#include "stages/stitch/lattice_plan.h"

namespace voxweld::bench {

GyroidTile::GyroidTile() {
  const GyroidVolume volume(160);
  ContourParameters parameters = gyroid_parameters();
  parameters.simplify.overhang = 1;  // as refine wants it
  ContourOptions options;
  options.tile_vertices = 1000000000;
  bricks = build_bricks(volume, parameters, options);
  plan = plan_tiles(bricks);
  mesh = stitched();
  frame = {plan_lattice({volume.size, {1, 1, 1}, options.precision}), {1, 1, 1}, {}, volume.size};
}

}  // namespace voxweld::bench
