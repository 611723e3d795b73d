// The vertices that remain of a brick's clusters, in order, where each finest sheet went, and what
// merge needs to go on above.
#pragma once

#include "stages/build/brick_nodes.h"
#include "storage/types/node_record.h"

namespace voxweld {

class BrickLeaves {
 public:
  // A sheet goes to the highest of its clusters that has collapsed.
  // Appends to `out`: its vertices (by node from the top down, in Morton order, then by first cell
  // and sheet), their counts by block, its leaf counts and residuals. Where each sheet collapses by
  // itself, counts and residuals are those of what nothing above the brick can take in, and those
  // by block what they were if nothing above blocks had collapsed: the same for bricks of any size.
  // (`nodes` is only read, but for buffers.)
  void collect(const BrickFrame& frame, const ActiveCells& cells, BrickNodes& nodes,
               const ContourParameters& parameters, BrickOctree& out);

  // The vertex that stands for `edge` of the active cell.
  std::uint32_t vertex(const ActiveCells& cells, std::size_t cell, int edge,
                       const BrickOctree& brick) const {
    const std::uint32_t first = first_vertex_[cell];
    const CellSheets& sheets = cells.sheets(cell);
    if (sheets.sheets == 1) return first;
    const std::uint32_t sheet = sheets.sheet_of_edge[static_cast<std::size_t>(edge)];
    if ((first & apart) != 0) return apart_[(first & ~apart) + sheet];
    // A cell of several sheets is its own leaf, but under topology = "free".
    return brick.vertices[first].leaf.level() > 0 ? first : first + sheet;
  }
  // Precondition: sheets do not collapse by themselves.
  std::uint32_t first_vertex(std::size_t cell) const { return first_vertex_[cell]; }

  // Where sheets collapse by themselves: of the brick as a node, to ClusterReduction.
  const NodeRecord& record() const { return record_; }
  // And for each vertex the cluster of the record that it is of, or no_root.
  static constexpr std::uint8_t no_root = 255;
  const std::vector<std::uint8_t>& roots() const { return roots_; }

 private:
  void visit(int l, std::size_t node, bool covered);
  void add_cell(std::size_t cell, bool covered);
  void take_in_cells(int l, std::size_t node, std::uint32_t vertex);
  std::uint32_t inherited(int l, std::size_t cluster) const;
  std::uint32_t root_of(int l, std::size_t cluster) const;
  void add_cluster(int l, std::size_t cluster, bool shares);
  void add_vertex(LeafCode leaf, const NodeSolution& solution,
                  const std::array<PackedNormal, max_clusters>& normals, LeafCounts& counts);
  void solve_finest(const BrickFrame& frame, const ContourParameters& parameters);
  void begin_record(const BrickFrame& frame, BrickNodes& nodes);
  LeafCounts& counts_of(std::uint8_t root);
  void find_roots(int top);
  void count_blocks(const BrickFrame& frame);

  const ActiveCells* cells_ = nullptr;
  const BrickNodes* nodes_ = nullptr;
  BrickOctree* out_ = nullptr;
  // Of each active cell: its vertex, or the first of several; with this bit a place in `apart_`,
  // where its sheets' vertices follow each other.
  static constexpr std::uint32_t apart = 0x80000000u;
  std::vector<std::uint32_t> first_vertex_, apart_;
  std::vector<std::vector<std::uint32_t>> vertices_;  // of each level's clusters, or no_cluster
  std::vector<std::vector<std::uint32_t>> root_clusters_;  // of each level's clusters but level 0's
  std::vector<std::uint8_t> roots_;
  NodeRecord record_;
  LeafCounts final_;  // of vertices without a root
  struct Finest {
    std::uint32_t cell, cluster, vertex;
  };
  std::vector<Finest> finest_;  // whose QEF is still to be solved
  std::vector<std::uint8_t> taken_, taken_above_;  // of the clusters of two levels
};

}  // namespace voxweld
