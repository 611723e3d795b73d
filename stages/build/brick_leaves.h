// The leaves that remain after simplification, their vertices in order, and where each finest
// cell's sheets went.
#pragma once

#include "stages/build/brick_nodes.h"

namespace voxweld {

class BrickLeaves {
 public:
  // Appends to `out`: its vertices, their counts by block, its leaf counts and residuals.
  void collect(const BrickFrame& frame, const ActiveCells& cells, const BrickNodes& nodes,
               const ContourParameters& parameters, BrickOctree& out);

  // The vertex that stands for `edge` of the active cell.
  std::uint32_t vertex(const ActiveCells& cells, std::size_t cell, int edge,
                       const BrickOctree& brick) const {
    const std::uint32_t first = first_vertex_[cell];
    const CellSheets& sheets = cells.sheets(cell);
    // A cell of several sheets is its own leaf, but under topology = "free".
    if (sheets.sheets == 1 || brick.vertices[first].leaf.level() > 0) return first;
    return first + sheets.sheet_of_edge[static_cast<std::size_t>(edge)];
  }
  std::uint32_t first_vertex(std::size_t cell) const { return first_vertex_[cell]; }

 private:
  void visit(int l, std::size_t node);
  void add_leaf(int l, std::size_t node);
  void add_cell(std::size_t cell);
  void add_vertex(LeafCode leaf, const NodeSolution& solution,
                  const std::array<PackedNormal, max_clusters>& normals);
  void note_finest(const NodeSolution& solution);
  void solve_pending(const BrickFrame& frame, const ContourParameters& parameters);

  const ActiveCells* cells_ = nullptr;
  const BrickNodes* nodes_ = nullptr;
  BrickOctree* out_ = nullptr;
  std::vector<std::uint32_t> first_vertex_;  // of each active cell
  struct Pending {
    std::uint32_t cell, vertex;
  };
  std::vector<Pending> pending_;  // finest cells whose QEF is still to be solved
};

}  // namespace voxweld
