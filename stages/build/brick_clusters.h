// One brick's octree while it is simplified, every sheet of the surface by itself: linear, a sorted
// array a level, homogeneous space left out. A node has the clusters of its sheets
// (node_shape.h), each with a QEF of its own, whatever becomes of those below. So a cluster takes in
// its sheets wherever it may collapse, even if one below it does not.
#pragma once

#include <cstdint>
#include <vector>

#include "stages/build/active_cells.h"
#include "stages/build/brick_nodes.h"
#include "stages/contouring/node_shape.h"

namespace voxweld {

// What is known of a node's clusters.
enum class NodeKind : std::uint8_t {
  simple,   // one, that the signs at half the node's side say is a disc as ClusterRules has it: its
            // shape follows from signs
  shaped,   // its shape is kept
  blocked,  // nothing: those below stay by themselves
};

struct SheetCluster {
  Qef qef;
  NormalClusters normals;
  NodeSolution
      solution;  // of those that may collapse; finest ones are solved where they are leaves
  std::uint32_t parent = no_cluster;  // in the level above
  LeafCode first;                     // its first finest cell and sheet, and the node's level
  bool collapses = false;             // it may, within the tolerance
};

struct ClusterLevel {
  std::vector<std::uint32_t> codes;          // Morton, in units of this level
  std::vector<std::uint32_t> first_child;    // in the level below; one more entry at the end
  std::vector<std::uint32_t> first_cluster;  // one more entry at the end
  std::vector<NodeKind> kinds;
  std::vector<std::uint8_t> closes;  // 1: some components of the surface lie in the node as a whole
  std::vector<SheetCluster> clusters;
};

class BrickClusters {
 public:
  struct Options {
    ClusterRules rules;
    bool signs = true;  // false: shapes of all nodes are put together, to check what signs say
  };
  BrickClusters() : BrickClusters(Options{}) {}
  explicit BrickClusters(const Options& options) : options_(options), merger_(options.rules) {}

  // Level 0 from the active cells, then all levels above.
  void simplify(const BrickFrame& frame, const SignGrid& signs, const ActiveCells& cells,
                const HermiteEdges& edges, const ContourParameters& parameters);

  const ClusterLevel& level(int l) const { return levels_[static_cast<std::size_t>(l)]; }
  // Whether all sheets in the node are of one cluster.
  bool is_one(int l, std::size_t node) const {
    const ClusterLevel& at = level(l);
    return at.first_cluster[node + 1] - at.first_cluster[node] == 1 && at.closes[node] == 0;
  }
  // Of the brick as a whole, unless it is blocked; lives until it is asked for again.
  NodeShape root_shape();

 private:
  // Of the shaped nodes of one level.
  struct Shapes {
    std::vector<std::uint32_t> place;  // of each node in what follows
    std::vector<std::uint32_t> first_cluster, first_curve, first_pair;  // one more entry at the end
    std::vector<std::int32_t> euler;
    std::vector<FaceCurve> curves;
    std::vector<CurvePair> pairs;
    void clear(std::size_t nodes);
    void add(std::size_t node, const NodeShape& shape);
  };
  // A simple node's, made when a parent asks.
  struct SimpleShape {
    std::array<FaceCurve, 6> curves;
    std::size_t count = 0;
  };

  void make_cells(const ActiveCells& cells, const HermiteEdges& edges);
  void make_level(int l);
  NodeKind classify(int l, std::size_t node);
  void shape_node(int l, std::size_t node);
  void add_clusters(int l, std::size_t node);
  void merge_level(int l);
  class MergeBatch;

  static NodeShape shape_of(const Shapes& shapes, std::size_t node);
  NodeShape simple_shape(int l, std::uint32_t code, SimpleShape& made) const;
  Crossing crossing_on(CellKey node, int edge) const;

  Options options_;
  ShapeMerger merger_;
  const SignGrid* signs_ = nullptr;
  const ActiveCells* cells_ = nullptr;
  BrickFrame frame_;
  ContourParameters parameters_;
  std::vector<ClusterLevel> levels_;
  Shapes shapes_, shapes_below_;  // of the level under way, and of that below
  std::array<SimpleShape, 8> simple_;
};

}  // namespace voxweld
