// Nodes of 2^3 cells whose QEF is made of the planes of their edges at once, not of those of their cells.
// A part of BrickNodes, for node_batches.cpp alone.
#pragma once

#include <algorithm>
#include <array>

#include "stages/build/brick_nodes.h"
#include "stages/build/cell_planes.h"
#include "stages/build/node_planes.h"

namespace voxweld {

class BrickNodes::PlaneMerges {
 public:
  PlaneMerges(BrickNodes& brick, const HermiteEdges& edges)
      : solver_(brick.parameters_),
        planes_(brick.parameters_.spacing),
        brick_(brick),
        edges_(edges) {
    solver_.clear_planes();
  }

  // One that BrickNodes::is_of_planes. flush() comes before anything is asked of its cluster.
  void add(std::size_t node) {
    const NodeLevel& at = brick_.level(1);
    const NodeLevel& cells = brick_.level(0);
    const LocalCell c = decode_local(at.codes[node] << 3);
    planes_.gather(count_, c, brick_.rule_->crossings(c.x, c.y, c.z), edges_);
    CellExtent extent = CellExtent::none();
    for (std::uint32_t cell = at.first_child[node]; cell < at.first_child[node + 1]; ++cell)
      extent.join(CellExtent{}.in_parent(static_cast<int>(cells.codes[cell] & 7)));
    solver_.set_extent(count_, extent);
    if (solver_.needs_centres())
      solver_.set_centre(count_,
                         node_centre(brick_.frame_, 1, at.codes[node], brick_.parameters_.spacing));
    nodes_[count_] = node;
    if (++count_ == lanes) flush();
  }

  void flush() {
    if (count_ == 0) return;
    NodeLevel& at = brick_.levels_[1];
    planes_.compute(solver_.planes());
    solver_.reduce();
    solver_.solve(1, count_);
    for (std::size_t i = 0; i < count_; ++i) {
      const std::uint32_t cluster = at.first_cluster[nodes_[i]];
      ClusterVertex& vertex = at.vertex(cluster);
      at.qef(cluster) = solver_.qef(i);
      vertex.solution = solver_.solution(i);
      at.clusters[cluster].collapses = solver_.within_tolerance(vertex.solution);
      vertex.normals = normals_of(i);
    }
    count_ = 0;
    planes_.clear();
    solver_.clear_planes();
  }

 private:
  // Where all are near their total, sums of some of them are, too: the cells' would be one cluster.
  NormalClusters normals_of(std::size_t lane) {
    const NodeLevel& at = brick_.level(1);
    const std::uint32_t begin = at.first_child[nodes_[lane]],
                        end = at.first_child[nodes_[lane] + 1];
    NormalSense sense = NormalSense::outward;
    for (std::uint32_t cell = begin; cell < end; ++cell)
      sense = std::max(sense, brick_.cells_->normal_sense(cell));
    const auto one = planes_.direction(lane, sense);
    return one ? NormalClusters{{*one}, sense} : normals_of_cells(begin, end);
  }
  NormalClusters normals_of_cells(std::size_t begin, std::size_t end) {
    const ActiveCells& cells = *brick_.cells_;
    ClusterMerge normals;
    for (std::size_t cell = begin; cell < end; ++cell) {
      gather_planes(cells.at(cell), cells.sheets(cell), all_sheets, edges_,
                    brick_.parameters_.spacing, of_cell_);
      normals.add(cluster_normals(of_cell_.normals(), cells.normal_sense(cell)));
    }
    return normals.merged();
  }

  NodeSolver solver_;
  NodePlanes planes_;
  BrickNodes& brick_;
  const HermiteEdges& edges_;
  SheetPlanes of_cell_;
  std::array<std::size_t, lanes> nodes_{};
  std::size_t count_ = 0;
};

}  // namespace voxweld
