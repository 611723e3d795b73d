#include "stages/build/cell_octree.h"

#include <type_traits>

#include "stages/build/brick_polygons.h"

namespace voxweld {
namespace {

// The corners of the brick's root, in the form of the record.
void set_corners(const SignGrid& signs, int side, RootRecord& root) {
  for (int corner = 0; corner < 8; ++corner)
    root.corner_signs |= static_cast<std::uint32_t>(signs.inside(
                             side * (corner & 1), side * (corner >> 1 & 1), side * (corner >> 2)))
                         << corner;
}
void set_corners(const LabelGrid& labels, int side, RootRecord& root) {
  for (int corner = 0; corner < 8; ++corner)
    root.corners[static_cast<std::size_t>(corner)] = labels.materials()[labels.at(
        side * (corner & 1), side * (corner >> 1 & 1), side * (corner >> 2))];
}

// What merge needs to go on: see NodeState.
template <class Grid>
RootRecord make_root(const BrickFrame& frame, const Grid& grid, const BrickNodes& nodes,
                     const ContourParameters& parameters, const BrickOctree& brick) {
  RootRecord root;
  set_corners(grid, frame.side(), root);
  if (!nodes.is_whole() || parameters.simplify.topology == Topology::free || nodes.by_sheets()) {
    root.state = NodeState::split;
    return root;
  }
  root.state = NodeState::leaf;
  const ClusterVertex& whole = nodes.level(frame.level).vertex(0);
  root.qef = nodes.level(frame.level).qef(0);
  root.clusters = whole.normals;
  root.vertex = brick.vertices[0];
  root.residual = whole.solution.residual;
  return root;
}

template <class Grid>
void build(const BrickFrame& frame, Index3 volume_size, const Grid& grid, const ActiveCells& cells,
           const HermiteEdges& edges, const ContourParameters& parameters, CellOctreeScratch& s,
           BrickOctree& out) {
  s.nodes.simplify(frame, grid, cells, edges, parameters);
  s.leaves.collect(frame, cells, s.nodes, out);
  emit_polygons(frame, volume_size, grid, cells, s.leaves, parameters, out);
  if (s.nodes.by_sheets())
    make_sheet_ghosts(cells, s.leaves, s.marks, out);
  else
    make_ghost_layer(cells, s.leaves, std::is_same_v<Grid, LabelGrid>, s.marks, out);
  out.root = make_root(frame, grid, s.nodes, parameters, out);
}

}  // namespace

void build_octree(const BrickFrame& frame, Index3 volume_size, const SignGrid& signs,
                  const ActiveCells& cells, const HermiteEdges& edges,
                  const ContourParameters& parameters, CellOctreeScratch& scratch,
                  BrickOctree& out) {
  build(frame, volume_size, signs, cells, edges, parameters, scratch, out);
}

void build_octree(const BrickFrame& frame, Index3 volume_size, const LabelGrid& labels,
                  const ActiveCells& cells, const HermiteEdges& edges,
                  const ContourParameters& parameters, CellOctreeScratch& scratch,
                  BrickOctree& out) {
  build(frame, volume_size, labels, cells, edges, parameters, scratch, out);
}

}  // namespace voxweld
