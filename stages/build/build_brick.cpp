#include "stages/build/build_brick.h"

#include <type_traits>

#include "stages/build/brick_polygons.h"
#include "stages/build/label_edits.h"
#include "stages/build/label_field.h"
#include "stages/build/label_hermite.h"
#include "stages/geometry/solid.h"

namespace voxweld {
namespace {

void clear(BrickOctree& brick, int level) {
  brick.vertices.clear();
  brick.polygons.clear();
  brick.emit_levels.clear();
  brick.blocks.assign(std::size_t{1} << 3 * (level - block_level), BlockCount{});
  brick.pairs.clear();
  brick.polygon_pairs.clear();
  brick.skin.sheets_of_edges.clear();
  brick.skin.cells.clear();
  brick.skin.vertices.clear();
  brick.root = RootRecord{};
  brick.counts = BrickCounts{};
}

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

// Of a brick without a surface.
RootRecord whole_brick(const SignGrid& signs) {
  RootRecord root;
  root.state = signs.inside(0, 0, 0) ? NodeState::inside : NodeState::outside;
  root.corner_signs = root.state == NodeState::inside ? 255 : 0;
  return root;
}
RootRecord whole_brick(const LabelGrid& labels) {
  RootRecord root;
  root.corners.fill(labels.materials()[labels.at(0, 0, 0)]);
  root.state = root.corners[0] == exterior ? NodeState::outside : NodeState::inside;
  return root;
}

// What merge needs to go on: see NodeState.
template <class Grid>
RootRecord make_root(const BrickFrame& frame, const Grid& grid, const BrickNodes& nodes,
                     const ContourParameters& parameters, const BrickOctree& brick) {
  RootRecord root;
  set_corners(grid, frame.side(), root);
  const NodeLevel& top = nodes.level(frame.level);
  if (top.leaf[0] == no_leaf || parameters.simplify.topology == Topology::free) {
    root.state = NodeState::split;
    return root;
  }
  const LeafData& leaf = top.leaves[top.leaf[0]];
  root.state = NodeState::leaf;
  root.qef = leaf.qef;
  root.clusters = leaf.clusters;
  root.vertex = brick.vertices[0];
  root.residual = leaf.solution.residual;
  return root;
}

}  // namespace

struct BrickScratch::Parts {
  SignGrid signs, solid_signs;
  ActiveCells cells;
  HermiteEdges edges, edges_before;
  LabelField labels;
  MaterialBlock materials;
  LabelGrid label_grid;
  LabelHermite label_edges;
  LabelEdits label_edits;
  BrickNodes nodes;
  BrickLeaves leaves;
  std::vector<std::uint32_t> vertex_marks;
};
namespace {

// What of a brick has to be looked at when all inside samples lie in a box: the cells with a corner
// there, and the samples that crossings and normals are made of.
struct Extent {
  Box3 samples;  // the box
  Box3 cells;    // relative to the brick, may reach beyond it
  Extent(const Box3& extent, const BrickFrame& frame)
      : samples(extent),  // lattice point u is sample u - 1; a cell reaches one point up
        cells{extent.lo - frame.origin, extent.hi + splat(1) - frame.origin} {}
};

// Crossings and normals of the volume's own surface.
void compute_edges(const HaloBlock& block, const BrickFrame& frame, const Extent& extent,
                   const ContourParameters& parameters, BrickScratch::Parts& s) {
  const std::optional<std::uint64_t>& label = parameters.surface.label;
  const Index3 origin = frame.origin;
  if (!label)
    return s.edges.compute(block, origin, frame.side(), s.signs, extent.cells, parameters);
  // Samples of the lattice points 0 .. side, and what their gradients read.
  const Box3 of_brick{frame.origin - splat(1 + gradient_halo),
                      frame.origin + splat(frame.side() + gradient_halo)};
  const Box3 of_edges{extent.samples.lo - splat(1 + gradient_halo),
                      extent.samples.hi + splat(1 + gradient_halo)};
  const Box3 box = intersect(intersect(of_brick, of_edges), Box3{{}, block.size});
  // Without samples only the ring's edges are there, which read none.
  HaloBlock field = block;
  if (!box.empty()) field = s.labels.filter(block, *label, box);
  s.edges.compute_label(field, origin, frame.side(), s.signs, extent.cells, parameters.spacing);
}

// Signs and Hermite edges after the edits that reach the brick; true when there are any.
bool apply_edits(const HaloBlock& block, const BrickFrame& frame, const Extent& extent,
                 const ContourParameters& parameters, BrickScratch::Parts& s) {
  const VolumeFrame volume{block.size, parameters.spacing};
  const Bounds bounds = brick_bounds({frame.origin, frame.level}, parameters.spacing);
  bool any = false;
  for (const Edit& edit : parameters.edits) {
    if (!edit_reaches(edit, bounds)) continue;
    if (!any) compute_edges(block, frame, extent, parameters, s);
    any = true;
    s.solid_signs.fill(edit.solid, volume, frame.origin, frame.side());
    s.signs.combine(edit.op, s.solid_signs);
    std::swap(s.edges, s.edges_before);
    s.edges.compute(edit, volume, frame.origin, frame.side(), s.signs, s.solid_signs,
                    s.edges_before);
  }
  return any;
}

}  // namespace

BrickScratch::BrickScratch() : parts_(std::make_unique<Parts>()) {}
BrickScratch::~BrickScratch() = default;

Box3 halo_samples(const BrickPlace& place, const ContourParameters& parameters) {
  // Lattice points -1 .. side + 1 for the signs of the cells -1 .. side; the gradient of a crossing
  // in the brick reaches from its lattice points 0 .. side. Lattice point u is sample u - 1.
  const std::int64_t side = std::int64_t{1} << place.level;
  const bool labels = parameters.surface.label || parameters.labels.mode != LabelMode::off;
  const int reach = gradient_halo + (labels ? label_halo : 0);
  return {place.origin - splat(1 + reach), place.origin + splat(side + reach)};
}

Bounds brick_bounds(const BrickPlace& place, Vec3 spacing) {
  const std::int64_t side = std::int64_t{1} << place.level;
  const VolumeFrame frame{{}, spacing};
  // Lattice points -1 .. side + 1, as samples.
  return {frame.place_of_sample(place.origin - splat(2)),
          frame.place_of_sample(place.origin + splat(side))};
}

namespace {

// From the brick's active cells on.
template <class Grid>
void build_octree(const BrickFrame& frame, Index3 volume_size, const Grid& grid,
                  const ContourParameters& parameters, BrickScratch::Parts& s, BrickOctree& out) {
  s.nodes.simplify(frame, grid, s.cells, s.edges, parameters);
  s.leaves.collect(frame, s.cells, s.nodes, parameters, out);
  emit_polygons(frame, volume_size, grid, s.cells, s.leaves, parameters, out);
  make_skin(s.cells, s.leaves, std::is_same_v<Grid, LabelGrid>, s.vertex_marks, out);
  out.root = make_root(frame, grid, s.nodes, parameters, out);
}

HaloBlock part_of(const HaloBlock& block, const Box3& box) {
  HaloBlock part = block;
  part.samples = intersect(block.samples, box);
  const Index3 d = part.samples.lo - block.samples.lo;
  if (!part.samples.empty())
    part.data += static_cast<std::size_t>(d.z * block.slice + d.y * block.row + d.x) *
                 sample_bytes(block.type);
  return part;
}

void build_shared(const HaloBlock& block, const BrickFrame& frame,
                  const ContourParameters& parameters, BrickScratch::Parts& s, BrickOctree& out) {
  const Bounds bounds = brick_bounds({frame.origin, frame.level}, parameters.spacing);
  std::vector<const Edit*> edits;
  std::vector<Material> given;
  for (const Edit& edit : parameters.edits) {
    if (!edit_reaches(edit, bounds)) continue;
    edits.push_back(&edit);
    given.push_back(edit.material);
  }
  s.materials.fill(part_of(block, halo_samples({frame.origin, frame.level}, parameters)),
                   *parameters.labels.rules, given);
  s.label_grid.fill(s.materials, frame.origin, frame.side());
  if (!edits.empty()) {
    s.label_edges.compute(s.materials.block(), frame.origin, s.label_grid, parameters.spacing,
                          s.edges);
    for (const Edit* edit : edits)
      s.label_edits.apply(*edit, {block.size, parameters.spacing}, frame.origin, s.label_grid,
                          s.edges);
  }
  s.cells.find(s.label_grid);
  out.counts.active_cells = s.cells.size();
  if (s.cells.size() == 0) {
    out.root = whole_brick(s.label_grid);
    return;
  }
  if (edits.empty())
    s.label_edges.compute(s.materials.block(), frame.origin, s.label_grid, parameters.spacing,
                          s.edges);
  build_octree(frame, block.size, s.label_grid, parameters, s, out);
}

}  // namespace

void build_brick(const HaloBlock& block, const BrickPlace& place,
                 const ContourParameters& parameters, BrickScratch& scratch, BrickOctree& out) {
  build_brick(block, place, block.samples, parameters, scratch, out);
}

void build_brick(const HaloBlock& block, const BrickPlace& place, const Box3& extent,
                 const ContourParameters& parameters, BrickScratch& scratch, BrickOctree& out) {
  BrickScratch::Parts& s = scratch.parts();
  const BrickFrame frame{place.origin, place.level, domain_level(block.size)};
  clear(out, place.level);
  if (parameters.labels.mode == LabelMode::shared)
    return build_shared(block, frame, parameters, s, out);
  // Solids may lie anywhere.
  const Box3 everywhere{place.origin - splat(2), place.origin + splat(frame.side() + 1)};
  const Extent looked_at(parameters.edits.empty() ? extent : everywhere, frame);
  s.signs.fill(block, place.origin, frame.side(), parameters.surface, looked_at.samples);
  const bool edited = apply_edits(block, frame, looked_at, parameters, s);
  s.cells.find(s.signs, frame.side(), looked_at.cells);
  out.counts.active_cells = s.cells.size();
  if (s.cells.size() == 0) {
    out.root = whole_brick(s.signs);
    return;
  }
  if (!edited) compute_edges(block, frame, looked_at, parameters, s);
  build_octree(frame, block.size, s.signs, parameters, s, out);
}

std::uint64_t build_brick_bytes(int level) {
  const std::uint64_t side = std::uint64_t{1} << level;
  const std::uint64_t cells = side * side * side, points = (side + 3) * (side + 3) * (side + 3);
  // Worst cases: every lattice edge crosses (3 a cell, and a polygon each); every cell is active. A
  // cell keeps either a QEF (and the level above an eighth of those, and so on) or up to four
  // sheets, each a SheetVertex and a LeafVertex. Vectors may have grown to twice their content.
  const std::uint64_t per_edge = sizeof(HermiteEdge) + 2 * sizeof(PolygonRefs);
  const std::uint64_t per_cell =
      16 + std::uint64_t{2} * 4 * (sizeof(SheetVertex) + sizeof(LeafVertex));
  const std::uint64_t filtered = (side + 11) * (side + 11) * (side + 11);
  return points / 2 + 2 * filtered * sizeof(std::int32_t) + 3 * cells * per_edge + cells * per_cell;
}

std::uint64_t build_labels_bytes(int level) {
  const std::uint64_t side = std::uint64_t{1} << level;
  const std::uint64_t samples = (side + 10) * (side + 10) * (side + 10);
  const std::uint64_t points = (side + 1) * (side + 1) * (side + 1), cells = side * side * side;
  // Of a sample: its number, its label in a table of nodes, and its places in two lists; of a point
  // its label before and after an edit. A cell has its sheets, and three polygons with a pair each,
  // listed and in a table; vectors may have grown to twice their content.
  const std::uint64_t per_sample = 4 + 64 + 2 * (8 + 8 + 4);
  const std::uint64_t per_cell = 2 * 40 + std::uint64_t{3} * (2 * (4 + sizeof(MaterialPair)) + 56);
  return samples * per_sample + 2 * points * sizeof(std::uint32_t) + cells * per_cell +
         LabelHermite::memory_bytes();
}

}  // namespace voxweld
