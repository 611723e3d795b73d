#include "stages/build/brick_leaves.h"

#include <algorithm>

#include "stages/build/cell_planes.h"

namespace voxweld {

void BrickLeaves::collect(const BrickFrame& frame, const ActiveCells& cells,
                          const BrickNodes& nodes, const ContourParameters& parameters,
                          BrickOctree& out) {
  cells_ = &cells;
  nodes_ = &nodes;
  out_ = &out;
  first_vertex_.resize(cells.size());
  pending_.clear();
  for (std::size_t node = 0; node < nodes.level(frame.level).codes.size(); ++node)
    visit(frame.level, node);
  solve_pending(frame, parameters);
  out.counts.vertices = out.vertices.size();
}

void BrickLeaves::visit(int l, std::size_t node) {
  const NodeLevel& level = nodes_->level(l);
  if (l == 0) {
    add_cell(node);
    return;
  }
  if (level.leaf[node] != no_leaf) {
    add_leaf(l, node);
    return;
  }
  for (std::uint32_t child = level.first_child[node]; child < level.first_child[node + 1]; ++child)
    visit(l - 1, child);
}

void BrickLeaves::add_leaf(int l, std::size_t node) {
  const NodeLevel& level = nodes_->level(l);
  const LeafData& leaf = level.leaves[level.leaf[node]];
  // The finest cells below: the children's ranges, level by level down.
  std::size_t begin = node, end = node + 1;
  for (int below = l; below > 0; --below) {
    begin = nodes_->level(below).first_child[begin];
    end = nodes_->level(below).first_child[end];
  }
  const auto vertex = static_cast<std::uint32_t>(out_->vertices.size());
  std::fill(first_vertex_.begin() + static_cast<std::ptrdiff_t>(begin),
            first_vertex_.begin() + static_cast<std::ptrdiff_t>(end), vertex);
  const LeafCode code = LeafCode::make(level.codes[node] << (3 * l), l, 0);
  add_vertex(code.with(leaf.clusters.sense), leaf.solution, pack_clusters(leaf.clusters));
  out_->counts.worst_residual =
      std::max(out_->counts.worst_residual, static_cast<double>(leaf.solution.residual));
}

void BrickLeaves::add_cell(std::size_t cell) {
  const std::uint32_t code = cells_->code(cell), first_sheet = nodes_->first_sheet(cell);
  const NormalSense sense = cells_->normal_sense(cell);
  first_vertex_[cell] = static_cast<std::uint32_t>(out_->vertices.size());
  if (first_sheet == no_leaf) {
    const NodeLevel& level = nodes_->level(0);
    pending_.push_back({static_cast<std::uint32_t>(cell), first_vertex_[cell]});
    add_vertex(LeafCode::make(code, 0, 0).with(sense), {},
               pack_clusters(level.leaves[level.leaf[cell]].clusters));
    return;
  }
  for (int s = 0; s < cells_->sheets(cell).sheets; ++s) {
    const SheetVertex& sheet = nodes_->sheet(first_sheet + static_cast<std::size_t>(s));
    add_vertex(LeafCode::make(code, 0, s).with(sense), sheet.solution, sheet.normals);
    note_finest(sheet.solution);
  }
}

void BrickLeaves::add_vertex(LeafCode leaf, const NodeSolution& solution,
                             const std::array<PackedNormal, max_clusters>& normals) {
  out_->vertices.push_back({leaf, solution.offset, normals});
  ++out_->blocks[leaf.code() >> (3 * block_level)].vertices;
  if (leaf.sheet() == 0) ++out_->counts.leaves[static_cast<std::size_t>(leaf.level())];
}

void BrickLeaves::note_finest(const NodeSolution& solution) {
  double& worst = out_->counts.worst_finest;
  worst = std::max(worst, static_cast<double>(solution.residual));
}

void BrickLeaves::solve_pending(const BrickFrame& frame, const ContourParameters& parameters) {
  const NodeLevel& level = nodes_->level(0);
  NodeSolver solver(parameters);
  for (std::size_t begin = 0; begin < pending_.size(); begin += lanes) {
    const std::size_t count = std::min(lanes, pending_.size() - begin);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t cell = pending_[begin + i].cell;
      solver.load(i, level.leaves[level.leaf[cell]].qef);
      if (solver.needs_centres())
        solver.set_centre(i, node_centre(frame, 0, cells_->code(cell), parameters.spacing));
    }
    solver.solve(0, count);
    for (std::size_t i = 0; i < count; ++i) {
      const NodeSolution solution = solver.solution(i);
      out_->vertices[pending_[begin + i].vertex].offset = solution.offset;
      note_finest(solution);
    }
  }
}

}  // namespace voxweld
