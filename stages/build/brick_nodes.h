// One brick's octree while it is simplified: linear, a sorted array a level, homogeneous space left
// out. A node has clusters of sheets (stages/contouring/node_shape.h), each with a QEF of its own.
//
// topology = "manifold": every cluster of a node by itself, whatever becomes of those below: it
// takes in its sheets wherever it may collapse, even if one below it does not. "safe" and labels: a
// node has one cluster, where signs allow it and all its children's have collapsed, else none.
// "free": the same without a look at signs; a cell's sheets are one cluster, whatever they are.
//
// Levels are made block by block as far as block_level, then as a whole: what a block needs stays in
// the cache, and is gone when it is done. Left are all clusters, the vertices of those above finest
// cells and of the finest that nothing in their block has taken in, and the QEFs of whole blocks up.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "stages/build/active_cells.h"
#include "stages/build/hermite.h"
#include "stages/contouring/node_shape.h"
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

// What is known of a node's clusters.
enum class NodeKind : std::uint8_t {
  simple,   // one, that the signs at half the node's side say is a disc as ClusterRules has it: its
            // shape follows from signs
  shaped,   // its shape is kept
  blocked,  // nothing: those below stay by themselves
};

struct SheetCluster {
  std::uint32_t parent = no_cluster;  // in the level above
  LeafCode first;                     // its first finest cell and sheet, and the node's level
  bool collapses = false;             // it may, within the tolerance
};

struct ClusterVertex {
  NormalClusters normals;
  NodeSolution solution;  // of those that may collapse, above the finest level
};

// A sheet of a finest cell that is, or may be, a vertex of its own.
struct SheetVertex {
  NodeSolution solution;
  std::array<PackedNormal, max_clusters> normals;
};

struct NodeLevel {
  std::vector<std::uint32_t> codes;          // Morton, in units of this level
  std::vector<std::uint32_t> first_child;    // in the level below; one more entry at the end
  std::vector<std::uint32_t> first_cluster;  // one more entry at the end
  std::vector<NodeKind> kinds;
  std::vector<std::uint8_t> closes;  // 1: some components of the surface lie in the node as a whole
  std::vector<SheetCluster> clusters;
  // What clusters hold, from these on: they are most of the memory, so those that only the levels
  // next above ask for are kept for one block at a time (see BrickNodes).
  std::uint32_t first_vertex = 0, first_qef = 0;
  std::vector<ClusterVertex> vertices;
  std::vector<Qef> qefs;
  const ClusterVertex& vertex(std::size_t cluster) const {
    return vertices[cluster - first_vertex];
  }
  ClusterVertex& vertex(std::size_t cluster) { return vertices[cluster - first_vertex]; }
  const Qef& qef(std::size_t cluster) const { return qefs[cluster - first_qef]; }
  Qef& qef(std::size_t cluster) { return qefs[cluster - first_qef]; }
};

class BrickNodes {
 public:
  struct Options {
    ClusterRules rules;
    bool signs = true;  // false: shapes of all nodes are put together, to check what signs say
  };
  BrickNodes() : BrickNodes(Options{}) {}
  explicit BrickNodes(const Options& options) : options_(options), merger_(options.rules) {}

  // Level 0 from the active cells, then all levels above as far as the tests allow. All but
  // `parameters` live as long as this is looked at.
  void simplify(const BrickFrame& frame, const SignGrid& signs, const ActiveCells& cells,
                const HermiteEdges& edges, const ContourParameters& parameters);
  // Between labels.
  void simplify(const BrickFrame& frame, const LabelGrid& labels, const ActiveCells& cells,
                const HermiteEdges& edges, const ContourParameters& parameters);

  const NodeLevel& level(int l) const { return levels_[static_cast<std::size_t>(l)]; }
  // Whether each sheet collapses by itself.
  bool by_sheets() const { return by_sheets_; }
  // Whether all sheets in the node are of one cluster.
  bool is_one(int l, std::size_t node) const {
    const NodeLevel& at = level(l);
    return at.first_cluster[node + 1] - at.first_cluster[node] == 1 && at.closes[node] == 0;
  }
  // Whether the brick has become one vertex, the top level's first.
  bool is_whole() const;
  // Of the brick, unless its node is blocked; lives until it is asked for again.
  NodeShape root_shape();

  // A cell's sheets where each is its own vertex as soon as no node above takes the cell in, one
  // after the other; else no_cluster.
  std::uint32_t first_sheet(std::size_t cell) const { return first_sheet_[cell]; }
  // Of a finest cluster that no block has taken in, and whose cell has no such sheets.
  std::uint32_t own_sheet(std::size_t cluster) const { return own_sheet_[cluster]; }
  const SheetVertex& sheet(std::size_t i) const { return sheets_[i]; }

 private:
  // Of the shaped nodes of one level.
  struct Shapes {
    std::size_t first_node = 0;
    std::vector<std::uint32_t> place;  // of each node from there on, in what follows
    std::vector<std::uint32_t> first_cluster, first_curve, first_pair;  // one more entry at the end
    std::vector<std::int32_t> euler;
    std::vector<FaceCurve> curves;
    std::vector<CurvePair> pairs;
    void clear(std::size_t first);
    void add(std::size_t node, const NodeShape& shape);
    NodeShape of(std::size_t node) const;
  };
  // A simple node's, made when a parent asks.
  struct SimpleShape {
    std::array<FaceCurve, 6> curves;
    std::size_t count = 0;
  };

  void simplify(const CollapseRule& rule, const ActiveCells& cells, const HermiteEdges& edges);
  void begin_levels();
  void reserve_sheets();
  // Nodes of a level, or cells.
  struct Range {
    std::size_t begin = 0, end = 0;
  };
  class CellBatches;
  class MergeBatch;
  class PlaneMerges;
  class NodeMerges;
  void make_cells(Range cells, CellBatches& batches);
  bool is_of_planes(std::size_t node) const;
  void keep_cells(Range nodes, CellBatches& batches);
  void settle_cells(Range cells, CellBatches& batches);
  bool is_taken_in(std::size_t finest) const;
  void make_nodes(const HermiteEdges& edges);
  void make_blocks(const HermiteEdges& edges, NodeMerges& merges);
  Range make_level(int l, Range below);
  NodeKind classify(int l, std::size_t node);
  void shape_node(int l, std::size_t node);
  void add_clusters(int l, std::size_t node);

  NodeShape simple_shape(int l, std::uint32_t code, SimpleShape& made) const;
  Crossing crossing_on(CellKey node, int edge) const;
  Shapes& shapes(int l) { return shapes_[static_cast<std::size_t>(l)]; }
  int block_top() const { return std::min(block_level, frame_.level); }

  Options options_;
  ShapeMerger merger_;
  const CollapseRule* rule_ = nullptr;
  const SignGrid* signs_ = nullptr;  // none between labels
  const ActiveCells* cells_ = nullptr;
  BrickFrame frame_;
  ContourParameters parameters_;
  bool by_sheets_ = false, free_ = false;
  int highest_ = 0;  // level that may collapse
  std::vector<NodeLevel> levels_;
  std::vector<std::uint32_t> first_sheet_, own_sheet_;
  std::vector<SheetVertex> sheets_;
  std::vector<Shapes> shapes_;  // of each level
  std::array<SimpleShape, 8> simple_;
};

}  // namespace voxweld
