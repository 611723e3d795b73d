// The vertices that remain of a brick's clusters, in order, where each finest sheet went, and what
// merge needs to go on above.
#pragma once

#include "stages/build/brick_clusters.h"
#include "storage/types/node_record.h"

namespace voxweld {

class SheetLeaves {
 public:
  // A sheet goes to the highest of its clusters that collapses, whatever those below it do.
  // Appends to `out`: its vertices (by node from the top down, in Morton order, then by first cell
  // and sheet), its leaf counts and residuals, these of what nothing above the brick can take in.
  // blocks[b].vertices: those there were if nothing above blocks had collapsed, the same for bricks
  // of any size. (`clusters` is only read, but for buffers.)
  void collect(const BrickFrame& frame, const ActiveCells& cells, BrickClusters& clusters,
               const ContourParameters& parameters, BrickOctree& out);

  // Of the brick as a node, to ClusterReduction.
  const NodeRecord& record() const { return record_; }
  // For each vertex the cluster of the record that it is of, or no_root.
  static constexpr std::uint8_t no_root = 255;
  const std::vector<std::uint8_t>& roots() const { return roots_; }

  // The vertex that stands for `edge` of the active cell.
  std::uint32_t vertex(const ActiveCells& cells, std::size_t cell, int edge) const {
    const ClusterLevel& level = clusters_->level(0);
    const std::uint32_t first = level.first_cluster[cell];
    if (level.first_cluster[cell + 1] - first == 1) return vertices_[0][first];
    return vertices_[0][first + cells.sheets(cell).sheet_of_edge[static_cast<std::size_t>(edge)]];
  }

 private:
  void visit(int l, std::size_t node, bool covered);
  void pass_down(int l, std::size_t node, std::uint32_t vertex);
  std::uint32_t inherited(int l, std::size_t cluster) const;
  std::uint32_t root_of(int l, std::size_t cluster) const;
  void add_vertex(int l, std::size_t cluster, bool shares);
  void begin_record(const BrickFrame& frame, BrickClusters& clusters);
  LeafCounts& counts_of(std::uint8_t root);
  void find_roots(int top);
  void solve_finest(const BrickFrame& frame, const ContourParameters& parameters);
  void count_blocks(const BrickFrame& frame);

  const ActiveCells* cells_ = nullptr;
  const BrickClusters* clusters_ = nullptr;
  BrickOctree* out_ = nullptr;
  std::vector<std::vector<std::uint32_t>> vertices_;  // of each level's clusters, or no_cluster
  std::vector<std::vector<std::uint32_t>> root_clusters_;  // of each level's clusters but level 0's
  std::vector<std::uint8_t> roots_;
  NodeRecord record_;
  LeafCounts final_;  // of vertices without a root
  struct Finest {
    std::uint32_t cell, sheet, vertex;
  };
  std::vector<Finest> finest_;                     // whose QEF is still to be solved
  std::vector<std::uint8_t> taken_, taken_above_;  // of the clusters of two levels
};

}  // namespace voxweld
