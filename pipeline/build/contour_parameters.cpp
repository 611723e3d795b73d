#include "pipeline/build/contour_parameters.h"

#include <utility>

#include "pipeline/config/edits.h"
#include "pipeline/solids/edit_meshes.h"
#include "pipeline/solids/mesh_input.h"
#include "stages/contouring/stored_surface.h"

namespace voxweld {
namespace {

// The config's edits are in output coordinates; a mesh as input comes before them.
Edits make_edits(const Config& config, const VolumeGeometry& geometry,
                 const std::optional<Solid>& input) {
  Edits edits = edits_of(config);
  for (Edit& edit : edits) edit.solid.center = edit.solid.center - geometry.first;
  load_edit_meshes(config, geometry, edits);
  if (!input) return edits;
  warn_of_cut_edits(geometry, edits);
  edits.insert(edits.begin(), {EditOp::add, *input});
  return edits;
}

Gradient gradient_of(SurfaceConfig::Gradient gradient) {
  switch (gradient) {
    case SurfaceConfig::Gradient::eno:
      return Gradient::eno;
    case SurfaceConfig::Gradient::central:
      return Gradient::central;
    case SurfaceConfig::Gradient::automatic:
    case SurfaceConfig::Gradient::subcell:
      break;
  }
  return Gradient::subcell;
}

Topology topology_of(const Config& config) {
  if (config.simplify.topology == SimplifyConfig::Topology::free) return Topology::free;
  return collapses_by_sheets(config) ? Topology::manifold : Topology::safe;
}

}  // namespace

double absolute_tolerance(const Config& config, const VolumeGeometry& geometry) {
  const bool voxels = config.simplify.tolerance_unit == SimplifyConfig::Unit::voxel;
  return config.simplify.tolerance * (voxels ? smallest_spacing(geometry) : 1.0);
}

ContourParameters contour_parameters(const Config& config, const VolumeInfo& info,
                                     const std::optional<Solid>& input, LabelParameters labels) {
  // The enumerators of both come in the order of the settings' table.
  const VolumeGeometry& geometry = info.geometry;
  ContourParameters p;
  p.spacing = geometry.spacing;
  p.surface.label = config.surface.label;
  p.surface.isovalue = config.surface.isovalue.value();
  p.surface.inside =
      config.surface.inside == SurfaceConfig::Inside::above ? Inside::above : Inside::below;
  if (!p.surface.label && labels.mode == LabelMode::off)
    to_stored(p.surface, info.scale, info.type);
  p.surface.border =
      config.surface.border == SurfaceConfig::Border::closed ? Border::closed : Border::open;
  p.surface.gradient = gradient_of(config.surface.gradient);
  p.surface.noise = config.surface.noise.value_or(0);
  p.labels = std::move(labels);
  const SimplifyConfig& s = config.simplify;
  p.simplify.enabled = s.enabled;
  p.simplify.tolerance = absolute_tolerance(config, geometry);
  p.simplify.overhang = vertex_overhang(config);
  p.simplify.metric = s.metric == SimplifyConfig::Metric::rms ? Metric::rms : Metric::sum;
  p.simplify.topology = topology_of(config);
  p.simplify.qef = s.qef == SimplifyConfig::Qef::qr ? QefForm::qr : QefForm::normal;
  p.edits = make_edits(config, geometry, input);
  return p;
}

}  // namespace voxweld
