// Vertices onto the output lattice, once and for all (DESIGN: the output lattice).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "storage/types/brick_octree.h"
#include "storage/types/output_lattice.h"

namespace voxweld {

// Frame of the snap: lattice point u of the volume lies at (first + u - 1) * spacing.
struct SnapFrame {
  OutputLattice lattice;
  Vec3 spacing{1, 1, 1};
  Index3 first{};  // as LatticeRequest has it
};

// The nearest lattice point strictly inside the leaf's box, so that vertices of different leaves
// never coincide.
LatticePoint snap_vertex(const SnapFrame& frame, CellKey leaf, const std::array<float, 3>& offset);

// The nearest lattice point, inside the leaf or not.
LatticePoint point_of(const SnapFrame& frame, CellKey leaf, const std::array<float, 3>& offset);

// The sheets of one finest cell, in their order: a taken point yields the nearest free one inside.
// Returns the point of the last of them.
LatticePoint snap_sheets(const SnapFrame& frame, CellKey leaf, std::span<const LeafVertex> sheets);

}  // namespace voxweld
