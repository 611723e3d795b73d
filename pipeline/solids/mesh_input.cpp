#include "pipeline/solids/mesh_input.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/solids/closed_mesh.h"
#include "storage/support/error.h"
#include "storage/volumes/filters.h"

namespace voxweld {
namespace {

double longest_side(const Bounds& bounds) {
  const Vec3 size = bounds.hi - bounds.lo;
  return std::max({size.x, size.y, size.z});
}

// The largest power of two that is no more than a quarter of the cell: steps of the output's
// lattice, powers of two as well, are no larger.
double coarsest_step(double cell) {
  int exponent = 0;
  std::frexp(cell / 4, &exponent);
  return std::ldexp(1.0, exponent - 1);
}

void check_cells(const InputConfig& config, double cell, double longest) {
  const auto refuse = [&](const std::string& problem) {
    throw InputError(fmt::format("{}: {}", config.path.string(), problem));
  };
  if (!(longest > 0) || !std::isfinite(longest))
    refuse(fmt::format("the mesh is {} across, so there are no cells to sample it by", longest));
  const double cells = longest / cell;
  if (cells < static_cast<double>(least_resolution))
    refuse(fmt::format(
        "input.cell = {:g}: the mesh is {:.6g} across, {:.3g} cells; expected at "
        "least {} cells, so lower it to {:.6g} or less",
        cell, longest, cells, least_resolution, longest / static_cast<double>(least_resolution)));
  const auto most = static_cast<double>(most_samples - 2 * config.margin - 4);
  if (cells > most)
    refuse(
        fmt::format("{} = {:g}: the mesh is {:.6g} across, which takes {:.0f} samples with "
                    "input.margin = {}; at most {} fit a side, so {} or {} is possible",
                    config.cell ? "input.cell" : "input.resolution",
                    config.cell ? cell : static_cast<double>(*config.resolution), longest,
                    cells + static_cast<double>(2 * config.margin + 4), config.margin, most_samples,
                    fmt::format("input.cell = {:.6g}", longest / most * 1.000001),
                    fmt::format("input.resolution = {:.0f}", most)));
}

}  // namespace

MeshVolume::MeshVolume(const VolumeGeometry& geometry, Solid solid)
    : space_(empty_source(geometry)), solid_(std::move(solid)) {
  info_ = space_->info();
  info_.format = "mesh";
}

VolumeGeometry mesh_geometry(const InputConfig& config, const Bounds& bounds) {
  const double longest = longest_side(bounds);
  const double cell =
      config.cell ? *config.cell : longest / static_cast<double>(config.resolution.value());
  check_cells(config, cell, longest);
  const double step = coarsest_step(cell), margin = static_cast<double>(config.margin);
  VolumeGeometry geometry;
  geometry.spacing = {cell, cell, cell};
  geometry.unit = config.unit;
  for (int a = 0; a < 3; ++a) {
    geometry.first[a] = std::floor((bounds.lo[a] - (margin + 0.5) * cell) / step) * step;
    const double last = std::floor((bounds.hi[a] - geometry.first[a]) / cell);
    geometry.size[a] = static_cast<std::int64_t>(last) + 2 + config.margin;
  }
  return geometry;
}

void warn_of_cut_edits(const VolumeGeometry& geometry, const Edits& edits) {
  const double cell = geometry.spacing.x;
  const VolumeFrame frame{geometry.size, geometry.spacing};
  const Vec3 last = frame.place_of_sample(geometry.size - splat(1));
  for (std::size_t i = 0; i < edits.size(); ++i) {
    const Solid& solid = edits[i].solid;
    if (edits[i].op != EditOp::add || solid.shape == SolidShape::plane) continue;
    const Bounds bounds = solid_bounds(solid);
    double out = 0;
    for (int a = 0; a < 3; ++a) out = std::max({out, -bounds.lo[a], bounds.hi[a] - last[a]});
    if (out <= 0) continue;
    const double margin = std::ceil((out + 1.5 * cell) / cell);
    spdlog::warn(
        "edit {} adds a solid that reaches {:.6g} beyond the space around the mesh and is "
        "cut off there: raise input.margin by {:.0f}",
        i + 1, out, margin);
  }
}

std::shared_ptr<MeshVolume> open_mesh_input(const Config& config) {
  const InputConfig& input = config.input;
  // What does not fit is streamed (streamed_mesh.h), but for winding numbers.
  const std::uint64_t budget = input.close == MeshClosing::winding
                                   ? config.run.memory
                                   : std::numeric_limits<std::uint64_t>::max();
  MeshFile file = read_closed_mesh(input.path, budget, input.close);
  const VolumeGeometry geometry = mesh_geometry(input, bounds_of(file.mesh));
  Solid solid;
  solid.shape = SolidShape::mesh;
  solid.center = Vec3{} - geometry.first;
  for (Vec3& v : file.mesh.vertices) v = v + solid.center;
  solid.mesh = make_solid(file.mesh, {geometry.size, geometry.spacing}, file.content, input.close);
  return std::make_shared<MeshVolume>(geometry, std::move(solid));
}

}  // namespace voxweld
