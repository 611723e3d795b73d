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

void SolidSides::begin(std::span<const Edit* const> edits, const VolumeFrame& frame, Index3 brick,
                       int side) {
  edits_ = edits;
  frame_ = frame;
  brick_ = brick;
  side_ = side;
  known_.fill(false);
}

const SignGrid& SolidSides::of(std::size_t i) {
  const bool keep = i < most_kept;
  SignGrid& sides = keep ? kept_[i] : other_;
  if (!keep || !known_[i]) sides.fill(edits_[i]->solid, frame_, brick_, side_);
  if (keep) known_[i] = true;
  return sides;
}

void BrickSurface::apply(const Edit& edit, const SignGrid& solid, const VolumeFrame& frame,
                         const BrickWindow& window) {
  signs_.combine(edit.op, solid);
  std::swap(edges_, edges_before_);
  edges_.compute(edit, frame, window.origin, window.side, signs_, solid, edges_before_);
}

void BrickSurface::add_common(const BrickSurface& other, const Edit& edit, const SignGrid& solid,
                              const VolumeFrame& frame, const BrickWindow& window) {
  Edit common;
  common.op = EditOp::intersect;
  common.solid = edit.solid;
  common_signs_ = other.signs_;
  common_signs_.combine(EditOp::intersect, solid);
  common_edges_.compute(common, frame, window.origin, window.side, common_signs_, solid,
                        other.edges_);
  signs_.combine(EditOp::add, common_signs_);
  std::swap(edges_, edges_before_);
  edges_.unite(window.side, signs_, edges_before_, common_edges_);
}

}  // namespace voxweld
