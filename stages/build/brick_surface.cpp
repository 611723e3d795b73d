#include "stages/build/brick_surface.h"

#include <utility>

namespace voxweld {

void BrickSurface::find_edges(const HaloBlock& block, const BrickWindow& window,
                              const ContourParameters& parameters) {
  const std::optional<std::uint64_t>& label = parameters.surface.label;
  if (!label)
    return edges_.compute(block, window.origin, window.side, signs_, window.cells, parameters);
  // Samples of the lattice points 0 .. side, and what their gradients read.
  const Box3 of_brick{window.origin - splat(1 + gradient_halo),
                      window.origin + splat(window.side + gradient_halo)};
  const Box3 of_edges{window.samples.lo - splat(1 + gradient_halo),
                      window.samples.hi + splat(1 + gradient_halo)};
  const Box3 box = intersect(intersect(of_brick, of_edges), Box3{{}, block.size});
  // Without samples only the ring's edges are there, which read none.
  HaloBlock field = block;
  if (!box.empty()) field = label_.filter(block, *label, box);
  edges_.compute_label(field, window.origin, window.side, signs_, window.cells, parameters.spacing);
}

void BrickSurface::apply(const Edit& edit, const VolumeFrame& frame, const BrickWindow& window) {
  solid_.fill(edit.solid, frame, window.origin, window.side);
  signs_.combine(edit.op, solid_);
  std::swap(edges_, edges_before_);
  edges_.compute(edit, frame, window.origin, window.side, signs_, solid_, edges_before_);
}

void BrickSurface::add_common(const BrickSurface& other, const Edit& edit, const VolumeFrame& frame,
                              const BrickWindow& window) {
  Edit common;
  common.op = EditOp::intersect;
  common.solid = edit.solid;
  solid_.fill(edit.solid, frame, window.origin, window.side);
  common_signs_ = other.signs_;
  common_signs_.combine(EditOp::intersect, solid_);
  common_edges_.compute(common, frame, window.origin, window.side, common_signs_, solid_,
                        other.edges_);
  signs_.combine(EditOp::add, common_signs_);
  std::swap(edges_, edges_before_);
  edges_.unite(window.side, signs_, edges_before_, common_edges_);
}

}  // namespace voxweld
