// The vertices that remain of a brick's clusters, in order, where each finest sheet went, and what
// merge needs to go on above.
#pragma once

#include "stages/build/brick_nodes.h"
#include "storage/types/node_record.h"

namespace voxweld {

class BrickLeaves {
 public:
  // A sheet goes to the highest of its clusters that has collapsed.
  // Appends to `out`: its vertices, their counts by block, its leaf counts and residuals, and where
  // each sheet collapses by itself the roots of vertices, the record of the brick as a node, and its
  // levels above the vertices. Then counts and residuals are those of what nothing above the brick
  // can take in, and those by block what they were if nothing above blocks had collapsed: the same
  // for bricks of any size.
  // (`nodes` is only read, but for buffers.)
  void collect(const BrickFrame& frame, const ActiveCells& cells, BrickNodes& nodes,
               BrickOctree& out);

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
  // Those of the cell's sheets: one of all, or with the bit `apart` a place in apart_vertices()
  // where they follow each other. Without the bit those of several sheets follow each other too,
  // unless the cell's leaf is larger.
  static constexpr std::uint32_t apart = 0x80000000u;
  std::uint32_t first_vertex(std::size_t cell) const { return first_vertex_[cell]; }
  const std::vector<std::uint32_t>& apart_vertices() const { return apart_; }

 private:
  void visit(int l, std::size_t node, bool covered);
  void add_cell(std::size_t cell, bool covered);
  void take_in_cells(int l, std::size_t node, std::uint32_t vertex);
  std::uint32_t inherited(int l, std::size_t cluster) const;
  std::uint32_t root_of(int l, std::size_t cluster) const;
  std::uint32_t kept_above(int l, std::size_t cluster) const;
  std::uint32_t keep(int l, std::size_t cluster, bool is_one);
  void add_cluster(int l, std::size_t cluster, bool shares);
  void add_finest(std::size_t cluster, NormalSense sense, bool shares);
  // What a vertex is, but for its place in the octree.
  struct VertexValue {
    const NodeSolution& solution;
    std::array<PackedNormal, max_clusters> normals;
    NormalSense sense;
  };
  void add_of_cluster(int l, std::size_t cluster, bool shares, const VertexValue& value);
  void add_vertex(LeafCode leaf, const NodeSolution& solution,
                  const std::array<PackedNormal, max_clusters>& normals, LeafCounts& counts);
  void begin_record(const BrickFrame& frame, BrickNodes& nodes);
  LeafCounts& counts_of(std::uint8_t root);
  void find_roots(int top);
  class BlockCounter;
  void count_blocks(const BrickFrame& frame);

  const ActiveCells* cells_ = nullptr;
  const BrickNodes* nodes_ = nullptr;
  BrickOctree* out_ = nullptr;
  std::vector<std::uint32_t> first_vertex_, apart_;
  std::vector<std::vector<std::uint32_t>> vertices_;  // of each level's clusters, or no_cluster
  std::vector<std::vector<std::uint32_t>> root_clusters_;  // of each level's clusters but level 0's
  // Of each level's clusters but level 0's, where nothing above has collapsed: itself or the next
  // above that is kept.
  std::vector<std::vector<std::uint32_t>> kept_;
  LeafCounts final_;  // of vertices without a root
  struct BlockScratch {
    // Of the clusters of two levels: whether one here or above has collapsed, else the next above
    // that could.
    std::vector<std::uint32_t> at, above;
    struct Candidate {
      float error = 0;
      std::uint32_t block = 0, parts = 0;
    };
    std::vector<Candidate> candidates;
  } blocks_;
};

// Whether a cluster above finest cells may collapse at some tolerance: what the rules keep apart has
// no solution.
inline bool may_collapse(const NodeLevel& level, std::size_t cluster) {
  return level.clusters[cluster].collapses || level.vertex(cluster).solution.residual > 0;
}

}  // namespace voxweld
