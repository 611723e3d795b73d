#include "pipeline/stage/volume.h"

#include <algorithm>
#include <bit>

#include "storage/types/counted_from_zero.h"

namespace voxweld {

double smallest_spacing(const VolumeGeometry& geometry) {
  return std::min({geometry.spacing.x, geometry.spacing.y, geometry.spacing.z});
}

BrickGrid brick_grid(const Config& config, const VolumeGeometry& geometry) {
  return BrickGrid(geometry.size, std::countr_zero(static_cast<std::uint64_t>(config.work.brick)),
                   static_cast<int>(config.work.shard));
}

VolumeGeometry output_geometry(const VolumeGeometry& geometry, const OutputLattice& lattice) {
  return moved(lattice, geometry.first).fits_floats() ? geometry : counted_from_zero(geometry);
}

}  // namespace voxweld
