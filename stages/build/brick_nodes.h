// One brick's octree while it is simplified: linear, a sorted array a level, homogeneous space left
// out.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "stages/build/active_cells.h"
#include "stages/build/hermite.h"
#include "stages/contouring/node_solver.h"
#include "storage/types/brick_octree.h"

namespace voxweld {

// Where a brick lies and how large it is.
struct BrickFrame {
  Index3 origin;         // lattice point of its lowest corner: the lowest cell
  int level = 6;         // side = 2^level cells
  int domain_level = 6;  // of the octree's root: nothing collapses above
  constexpr int side() const { return 1 << level; }
};

// What a node keeps once it is one leaf.
struct LeafData {
  Qef qef;
  NormalClusters clusters;
  NodeSolution solution;
};

inline constexpr std::uint32_t no_leaf = 0xffffffffu;

struct NodeLevel {
  std::vector<std::uint32_t> codes;        // Morton, in units of this level
  std::vector<std::uint32_t> first_child;  // in the level below; one more entry at the end
  std::vector<std::uint32_t> leaf;  // index into `leaves`, or no_leaf where the node is split
  std::vector<LeafData> leaves;
};

// A sheet of a cell that cannot collapse: its vertex at once.
struct SheetVertex {
  NodeSolution solution;
  std::array<PackedNormal, max_clusters> normals;
};

class BrickNodes {
 public:
  // Level 0 from the active cells, then all levels above as far as the tests allow.
  void simplify(const BrickFrame& frame, const CollapseRule& rule, const ActiveCells& cells,
                const HermiteEdges& edges, const ContourParameters& parameters);

  const NodeLevel& level(int l) const { return levels_[static_cast<std::size_t>(l)]; }
  // Level 0 nodes that cannot collapse have their sheets' vertices from here on, one a sheet.
  std::uint32_t first_sheet(std::size_t cell) const { return first_sheet_[cell]; }
  const SheetVertex& sheet(std::size_t i) const { return sheets_[i]; }

 private:
  void make_cells(const BrickFrame& frame, const ActiveCells& cells, const HermiteEdges& edges,
                  const ContourParameters& parameters);
  void make_level(int l);
  void collapse_level(int l, const BrickFrame& frame, const CollapseRule& rule,
                      const ContourParameters& parameters);
  void collapse_batch(int l, const std::vector<std::uint32_t>& nodes, std::size_t begin,
                      std::size_t end, NodeSolver& solver);
  bool children_are_leaves(int l, std::size_t node) const;

  std::vector<NodeLevel> levels_;
  std::vector<std::uint32_t> first_sheet_;
  std::vector<SheetVertex> sheets_;
  std::vector<std::uint32_t> candidates_;
};

}  // namespace voxweld
