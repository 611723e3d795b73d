// The combinatorics of one cell whose corners carry labels instead of signs: its sheets, and the
// collapse test.
//
// Based on: Ju, Losasso, Schaefer, Warren, "Dual Contouring of Hermite Data", 2002, sections 2.3
// and 4 (the multi-material case). Where it differs: a cell has one vertex for each component of
// its crossings, joined face by face, so that a finest cell between several labels has as many
// vertices as there are surfaces in it; the test for a simplex is asked of the corner labels
// directly.
//
// Corners, edges and faces are numbered as in cell_topology.h. Labels are numbers in which the
// order of the materials is kept; only their order and equality matter.
#pragma once

#include <array>
#include <cstdint>

#include "stages/contouring/cell_topology.h"

namespace voxweld {

using CellLabels = std::array<std::uint32_t, 8>;

// Crossings are joined face by face. With two of them on a face: an arc. With three, or with four
// labels: all are one. With labels a b / c a: an arc around b and one around c, so that a stays
// whole. With a b / b a: arcs around the smaller label.
// With two labels it is cell_sheets() of the smaller as inside, nothing joined.
CellSheets label_sheets(const CellLabels& labels);

// Shrinking the edges between equal corners leaves a simplex: 1 to 4 labels, each one component
// along cube edges, every two of them neighbours along one, and no face that touches one label
// twice. Then the interfaces in the cell are those of an edge, a triangle or a tetrahedron: one
// sheet, three sheets that meet in a line, or six that meet in a point.
// With two labels it is collapsible().
bool labels_collapsible(const CellLabels& labels);

// The labels of a node at half its side, at x + 3 y + 9 z.
using NodeLabels = std::array<std::uint32_t, 27>;

// The collapse test: the corners form a simplex, each edge's middle has the label of one of its
// ends, each face's of one of its corners, the centre that of one of the eight. With two labels it
// is signs_allow_collapse().
bool labels_allow_collapse(const NodeLabels& labels);

CellLabels corners_of_labels(const NodeLabels& labels);

}  // namespace voxweld
