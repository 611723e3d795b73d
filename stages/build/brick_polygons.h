// The polygons a brick owns, and the ghost layer its lower neighbours need for theirs.
//
// Based on: Ju, Losasso, Schaefer, Warren, "Dual Contouring of Hermite Data", 2002, section 3.2
// (the dual walk). Where it differs: on safe octrees the walk equals a flat pass over the finest
// lattice edges with a sign change, the polygon being the distinct leaves among the edge's four
// cells, if three or more are distinct; under topology = "free" an edge's polygon also needs to be
// the first crossing of a minimal edge whose ends differ.
#pragma once

#include "stages/build/brick_leaves.h"

namespace voxweld {

// volume_size: samples a side, for the edges that end in the ring. Appends to out.polygons,
// out.blocks, out.emit_levels, out.counts.crossing_edges.
void emit_polygons(const BrickFrame& frame, Index3 volume_size, const SignGrid& signs,
                   const ActiveCells& cells, const BrickLeaves& leaves,
                   const ContourParameters& parameters, BrickOctree& out);
// Between labels: also out.pairs and out.polygon_pairs.
void emit_polygons(const BrickFrame& frame, Index3 volume_size, const LabelGrid& labels,
                   const ActiveCells& cells, const BrickLeaves& leaves,
                   const ContourParameters& parameters, BrickOctree& out);

// False only when it is certain that the corners are no polygon: two foreign ones may still turn
// out to be one leaf.
bool may_be_polygon(const PolygonRefs& refs);

// scratch: one entry a vertex, any content. labels: whether the sheets of edges are needed, see
// GhostLayer.
// by_sheets of BrickNodes: the other.
void make_ghost_layer(const ActiveCells& cells, const BrickLeaves& leaves, bool labels,
                      std::vector<std::uint32_t>& scratch, BrickOctree& out);

// The same where each sheet collapses by itself.
void make_sheet_ghosts(const ActiveCells& cells, const BrickLeaves& leaves,
                       std::vector<std::uint32_t>& scratch, BrickOctree& out);

// Of these the vertices: marks has 1 for those that cells of the ghost layer name, and 0 for the
// others; then of each that is in the layer its place there. Appends to out.ghost.
void add_ghost_vertices(std::vector<std::uint32_t>& marks, BrickOctree& out);

}  // namespace voxweld
