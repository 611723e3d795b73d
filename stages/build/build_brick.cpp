#include "stages/build/build_brick.h"

#include <algorithm>

#include "stages/build/brick_surface.h"
#include "stages/build/cell_octree.h"
#include "stages/build/label_edits.h"
#include "stages/build/label_hermite.h"
#include "stages/build/label_part.h"
#include "stages/solids/solid.h"

namespace voxweld {
namespace {

void clear(BrickOctree& brick, int level) {
  brick.vertices.clear();
  brick.roots.clear();
  brick.record = {};
  brick.levels.clear();
  brick.ghost.apart.clear();
  brick.ghost.roots.clear();
  brick.polygons.clear();
  brick.emit_levels.clear();
  brick.blocks.assign(std::size_t{1} << 3 * (level - block_level), BlockCount{});
  brick.pairs.clear();
  brick.polygon_pairs.clear();
  brick.ghost.sheets_of_edges.clear();
  brick.ghost.cells.clear();
  brick.ghost.vertices.clear();
  brick.root = RootRecord{};
  brick.counts = BrickCounts{};
}

// Of a brick without a surface.
RootRecord whole_brick(NodeState side) {
  RootRecord root;
  root.state = side;
  root.corner_signs = side == NodeState::inside ? 255 : 0;
  return root;
}
RootRecord whole_brick(const SignGrid& signs) {
  return whole_brick(signs.inside(0, 0, 0) ? NodeState::inside : NodeState::outside);
}
RootRecord whole_brick(const LabelGrid& labels) {
  RootRecord root;
  root.corners.fill(labels.materials()[labels.at(0, 0, 0)]);
  root.state = root.corners[0] == exterior ? NodeState::outside : NodeState::inside;
  return root;
}

}  // namespace

struct BrickScratch::Parts {
  BrickSurface surface, any_label;
  SignGrid solid;
  ActiveCells cells;
  HermiteEdges label_edges;
  MaterialBlock materials;
  LabelGrid label_grid;
  LabelHermite label_hermite;
  LabelEdits label_edits;
  CellOctreeScratch octree;
};

BrickScratch::BrickScratch() : parts_(std::make_unique<Parts>()) {}
BrickScratch::~BrickScratch() = default;

void BrickScratch::free_buffers() {
  Parts& s = *parts_;
  s.surface.free_edges();
  s.any_label.free_edges();
  s.cells.free_lists();
  s.label_edges = {};
  s.octree = {};
}

Box3 halo_samples(const BrickPlace& place, const ContourParameters& parameters) {
  // Lattice points -1 .. side + 1 for the signs of the cells -1 .. side; the gradient of a crossing
  // in the brick reaches from its lattice points 0 .. side. Lattice point u is sample u - 1.
  const std::int64_t side = std::int64_t{1} << place.level;
  const bool labels = parameters.surface.label || parameters.labels.mode != LabelMode::off;
  const int reach = gradient_halo + (labels ? label_halo : 0);
  return {place.origin - splat(1 + reach), place.origin + splat(side + reach)};
}

// Of lattice points -1 .. side + 1.
Box3 sign_samples(const BrickPlace& place) {
  const std::int64_t side = std::int64_t{1} << place.level;
  return {place.origin - splat(2), place.origin + splat(side + 1)};
}

Bounds brick_bounds(const BrickPlace& place, Vec3 spacing) {
  const VolumeFrame frame{{}, spacing};
  const Box3 samples = sign_samples(place);
  return {frame.place_of_sample(samples.lo), frame.place_of_sample(samples.hi - splat(1))};
}

namespace {

// Of a label's filtered indicator (label_field.h).
std::uint64_t filtered_bytes(int level) {
  const std::uint64_t side = (std::uint64_t{1} << level) + 11;
  return 2 * side * side * side * sizeof(std::int32_t);
}

void reserve_for(const BrickScratch& scratch, int level, std::uint64_t active_cells) {
  if (scratch.reserve) scratch.reserve(build_brick_bytes(level, active_cells));
}
// Of the surface found.
void reserve_for(BrickScratch& scratch, int level, std::uint64_t active_cells,
                 const ContourParameters& parameters) {
  if (!collapses_by_sheets(parameters)) return reserve_for(scratch, level, active_cells);
  const BrickScratch::Parts& s = scratch.parts();
  if (scratch.reserve)
    scratch.reserve(
        build_sheets_bytes(level, active_cells, s.cells.most_sheets(s.surface.signs())) +
        (parameters.surface.label ? filtered_bytes(level) : 0));
}
// Before edits, whose crossings are found before it is known what they leave.
void reserve_worst(const BrickScratch& scratch, int level, const ContourParameters& parameters) {
  if (scratch.reserve)
    scratch.reserve(collapses_by_sheets(parameters) ? build_sheets_bytes(level)
                                                    : build_brick_bytes(level));
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
                  const ContourParameters& parameters, BrickScratch& scratch, BrickOctree& out) {
  BrickScratch::Parts& s = scratch.parts();
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
    reserve_worst(scratch, frame.level, parameters);
    s.label_hermite.compute(s.materials.block(), frame.origin, s.label_grid, parameters.spacing,
                            s.label_edges);
    for (const Edit* edit : edits)
      s.label_edits.apply(*edit, {block.size, parameters.spacing}, frame.origin, s.label_grid,
                          s.label_edges);
  }
  const std::size_t active = s.cells.count(s.label_grid);
  if (edits.empty()) reserve_for(scratch, frame.level, active);
  clear(out, frame.level);
  out.counts.active_cells = active;
  if (active == 0) {
    out.root = whole_brick(s.label_grid);
    return;
  }
  s.cells.find(s.label_grid);
  if (edits.empty())
    s.label_hermite.compute(s.materials.block(), frame.origin, s.label_grid, parameters.spacing,
                            s.label_edges);
  build_octree(frame, block.size, s.label_grid, s.cells, s.label_edges, parameters, s.octree, out);
}

// Of the surface found; with_edges: its crossings are.
void build_surface(const HaloBlock& block, const BrickFrame& frame, const BrickWindow& window,
                   bool with_edges, const ContourParameters& parameters, BrickScratch& scratch,
                   BrickOctree& out) {
  BrickScratch::Parts& s = scratch.parts();
  const std::size_t active = s.cells.count(s.surface.signs(), frame.side(), window.cells);
  if (!with_edges) reserve_for(scratch, frame.level, active, parameters);
  clear(out, frame.level);
  out.counts.active_cells = active;
  if (active == 0) {
    out.root = whole_brick(s.surface.signs());
    return;
  }
  s.cells.find(s.surface.signs());
  if (!with_edges) s.surface.find_edges(block, window, parameters);
  build_octree(frame, block.size, s.surface.signs(), s.cells, s.surface.edges(), parameters,
               s.octree, out);
}

// The edits that reach the brick; true when there are any.
bool apply_edits(const HaloBlock& block, const BrickPlace& place, const BrickWindow& window,
                 const ContourParameters& parameters, BrickScratch& scratch) {
  SignGrid& solid = scratch.parts().solid;
  BrickSurface& surface = scratch.parts().surface;
  const VolumeFrame frame{block.size, parameters.spacing};
  const Bounds bounds = brick_bounds(place, parameters.spacing);
  bool any = false;
  for (const Edit& edit : parameters.edits) {
    if (!edit_reaches(edit, bounds)) continue;
    if (!any) {
      reserve_worst(scratch, place.level, parameters);
      surface.find_edges(block, window, parameters);
    }
    any = true;
    solid.fill(edit.solid, frame, window.origin, window.side);
    surface.apply(edit, solid, frame, window);
  }
  return any;
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
  if (parameters.labels.mode == LabelMode::shared)
    return build_shared(block, frame, parameters, scratch, out);
  const BrickWindow window = parameters.edits.empty()
                                 ? BrickWindow(place.origin, frame.side(), extent)
                                 : BrickWindow::everywhere(place.origin, frame.side());
  s.surface.find_signs(block, window, parameters.surface);
  const bool edited = apply_edits(block, place, window, parameters, scratch);
  build_surface(block, frame, window, edited, parameters, scratch, out);
}

void build_brick(const HaloBlock& block, const BrickPlace& place, const LabelPart& part,
                 const ContourParameters& parameters, BrickScratch& scratch, BrickOctree& out) {
  BrickScratch::Parts& s = scratch.parts();
  const BrickFrame frame{place.origin, place.level, domain_level(block.size)};
  s.surface.find_signs(block, part.window(), parameters.surface);
  if (part.is_edited()) reserve_worst(scratch, place.level, parameters);
  const bool edited = part.apply_edits(block, parameters, s.surface, s.any_label);
  build_surface(block, frame, part.window(), edited, parameters, scratch, out);
}

void build_whole_brick(const BrickPlace& place, NodeState side, BrickOctree& out) {
  clear(out, place.level);
  out.root = whole_brick(side);
}

namespace {

// The worst cases of an active cell: three edges that cross and a polygon each, and those of the
// upper border planes. Polygons may have grown to twice their content.
std::uint64_t surface_bytes(int level, std::uint64_t active_cells) {
  const std::uint64_t side = std::uint64_t{1} << level;
  const std::uint64_t points = (side + 3) * (side + 3) * (side + 3);
  const std::uint64_t per_edge = sizeof(HermiteEdge) + 2 * sizeof(PolygonRefs);
  const std::uint64_t border = std::min(3 * side * side * 3, 4 * active_cells);
  return points / 2 + border * sizeof(HermiteEdge) + 3 * active_cells * per_edge;
}

}  // namespace

std::uint64_t build_brick_bytes(int level) {
  const std::uint64_t side = std::uint64_t{1} << level;
  return build_brick_bytes(level, side * side * side);
}

std::uint64_t build_brick_bytes(int level, std::uint64_t active_cells) {
  // A cell keeps either a QEF (and the level above an eighth of those, and so on) or up to four
  // sheets, each a SheetVertex and a LeafVertex. Vectors may have grown to twice their content.
  const std::uint64_t per_cell =
      16 + std::uint64_t{2} * 4 * (sizeof(SheetVertex) + sizeof(LeafVertex));
  return surface_bytes(level, active_cells) + filtered_bytes(level) + active_cells * per_cell;
}

std::uint64_t build_sheets_bytes(int level) {
  const std::uint64_t side = std::uint64_t{1} << level;
  return build_sheets_bytes(level, side * side * side, 4 * side * side * side) +
         filtered_bytes(level);
}

std::uint64_t build_sheets_bytes(int level, std::uint64_t active_cells, std::uint64_t sheets) {
  // Of a cell its lists. Of a sheet its cluster, and what it is by itself; up to 0.8 clusters above
  // it, with what tells where each of these went; and a vertex, with levels above it. Vectors may have
  // grown to twice their content, but those of the finest clusters.
  const std::uint64_t levels = 16 + 2 * (sizeof(KeptCluster) + sizeof(BlockMerge) + 12);
  const std::uint64_t per_sheet = sizeof(SheetCluster) + 4 + 2 * sizeof(SheetVertex) +
                                  2 * (sizeof(SheetCluster) + sizeof(ClusterVertex)) +
                                  3 * sizeof(LeafVertex) + 64 + levels;
  // Of one block what its finest clusters hold, no more than there are, and QEFs above them; and the
  // shapes of nodes: up to two curves a face of a finest cell, with half of the faces on the outside
  // of a node, half of these on that of its parent, and so on. From blocks up they are kept: three
  // faces of eight cells, and again half of them a level.
  constexpr std::uint64_t block_cells = std::uint64_t{1} << (3 * block_level);
  const std::uint64_t of_block =
      std::min(active_cells, block_cells) * 2 * 6 * sizeof(FaceCurve) +
      std::min(sheets, 4 * block_cells) * (sizeof(ClusterVertex) + (10 + 2 * 8) * sizeof(Qef) / 10);
  const std::uint64_t per_cell = 48 + 2 * (3 * sizeof(FaceCurve) / 2);
  return surface_bytes(level, active_cells) + of_block + active_cells * per_cell +
         sheets * per_sheet;
}

std::uint64_t build_labels_bytes(int level) {
  const std::uint64_t side = std::uint64_t{1} << level;
  const std::uint64_t samples = (side + 10) * (side + 10) * (side + 10);
  const std::uint64_t points = (side + 1) * (side + 1) * (side + 1), cells = side * side * side;
  // Of a sample: its number, its label in a table of nodes, and its places in two lists; of a point
  // its label before and after an edit. A cell has its sheets, and three polygons with a pair each,
  // listed and in a table; vectors may have grown to twice their content.
  const std::uint64_t per_sample = 4 + 64 + std::uint64_t{2} * (8 + 8 + 4);
  const std::uint64_t per_cell =
      std::uint64_t{2} * 40 + std::uint64_t{3} * (2 * (4 + sizeof(MaterialPair)) + 56);
  return samples * per_sample + 2 * points * sizeof(std::uint32_t) + cells * per_cell +
         LabelHermite::memory_bytes();
}

std::uint64_t build_replacing_bytes(int level) {
  const std::uint64_t side = std::uint64_t{1} << level;
  const std::uint64_t cells = side * side * side, points = (side + 3) * (side + 3) * (side + 3);
  // Sides and crossings of what is of any label, before and after an edit, and of what comes in;
  // the filtered field of any label.
  const std::uint64_t filtered = (side + 11) * (side + 11) * (side + 11);
  return points + 2 * filtered * sizeof(std::int32_t) +
         std::uint64_t{3} * 3 * cells * sizeof(HermiteEdge);
}

}  // namespace voxweld
