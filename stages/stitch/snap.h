// Vertices onto the output lattice, once and for all (DESIGN: the output lattice).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "storage/types/brick_octree.h"
#include "storage/types/lattice_frame.h"

namespace voxweld {

// The nearest lattice point strictly inside the leaf's box, so that vertices of different leaves
// never coincide.
LatticePoint snap_vertex(const LatticeFrame& frame, CellKey leaf,
                         const std::array<float, 3>& offset);

// The nearest lattice point, inside the leaf or not.
LatticePoint point_of(const LatticeFrame& frame, CellKey leaf, const std::array<float, 3>& offset);

// The sheets of one finest cell, in their order: a taken point yields the nearest free one inside.
// Returns the point of the last of them.
LatticePoint snap_sheets(const LatticeFrame& frame, CellKey leaf,
                         std::span<const LeafVertex> sheets);

// Of a node where each sheet is a vertex by itself. group: its vertices in their order up to the one
// wanted, offsets from its centre. shares: vertices of other nodes may lie in this one, as it may in
// theirs. Then each level has lattice points of its own: level 0 those whose coordinates modulo 3
// are 0 or 1, any other level those of one of the 19 other triples. So vertices never coincide.
LatticePoint snap_in_group(const LatticeFrame& frame, CellKey node, bool shares,
                           std::span<const std::array<float, 3>> group);

}  // namespace voxweld
