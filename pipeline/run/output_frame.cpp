#include "pipeline/run/output_frame.h"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "pipeline/filter/filter_source.h"
#include "pipeline/stage/volume.h"
#include "stages/stitch/lattice_plan.h"

namespace voxweld {
namespace {

void warn_of_origin(const Config& config, Vec3 first) {
  spdlog::warn(
      "{}: floats do not hold the {} coordinates at this output.precision: those of the files are "
      "less by [{}, {}, {}], which is in frame.origin of the manifest",
      config.input.path.string(), config.input.is_mesh() ? "mesh's own" : "whole volume's", first.x,
      first.y, first.z);
}

}  // namespace

OutputFrame output_frame(const Config& config, const VolumeGeometry& geometry) {
  LatticeRequest request{geometry.size, geometry.spacing,
                         config.output.precision * smallest_spacing(geometry)};
  const OutputLattice from_zero = plan_lattice(request);
  OutputFrame frame{
      output_geometry(geometry, from_zero), {from_zero, geometry.spacing, {}, geometry.size}, {}};
  if (frame.geometry.first != geometry.first) {
    warn_of_origin(config, geometry.first);
  } else if (config.input.crop && !std::ranges::any_of(config.filters, moves_samples)) {
    request.first = config.input.crop->lo;
    frame.volume = {plan_lattice(request), geometry.spacing, request.first, geometry.size};
  } else {
    frame.first = geometry.first;
  }
  return frame;
}

}  // namespace voxweld
