// Vertices onto the output lattice, once and for all (DESIGN: the output lattice).
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "storage/types/brick_octree.h"
#include "storage/types/output_lattice.h"

namespace voxweld {

// Frame of the snap: lattice point u of the volume lies at (first + u - 1) * spacing.
struct SnapFrame {
  OutputLattice lattice;
  Vec3 spacing{1, 1, 1};
  Index3 first{};  // as LatticeRequest has it
  // Samples a side of the volume, which ends where the next ones would be. No vertex lies beyond that,
  // but for at most most_snap_steps where others lie.
  Index3 size = splat(std::numeric_limits<std::int32_t>::max());
};

// The nearest lattice point strictly inside the leaf's box, so that vertices of different leaves
// never coincide.
LatticePoint snap_vertex(const SnapFrame& frame, CellKey leaf, const std::array<float, 3>& offset);

// The nearest lattice point, inside the leaf or not.
LatticePoint point_of(const SnapFrame& frame, CellKey leaf, const std::array<float, 3>& offset);

// The sheets of one finest cell, in their order: a taken point yields the nearest free one inside.
// Returns the point of the last of them.
LatticePoint snap_sheets(const SnapFrame& frame, CellKey leaf, std::span<const LeafVertex> sheets);

// Of a node where each sheet is a vertex by itself. group: its vertices in their order up to the one
// wanted, offsets from its centre. shares: vertices of other nodes may lie in this one, as it may in
// theirs. Then each level has lattice points of its own: level 0 those whose coordinates modulo 3
// are 0 or 1, any other level those of one of the 19 other triples. So vertices never coincide.
LatticePoint snap_in_group(const SnapFrame& frame, CellKey node, bool shares,
                           std::span<const std::array<float, 3>> group);

}  // namespace voxweld
