// What must be known of the surface in an octree node to tell which of its pieces may become one
// vertex, put together from the same of its eight children. So a node needs its children's shapes
// and no sample, whether they lie in one brick or in several files.
//
// Sheets of finest cells (cell_topology.h) that meet in an arc on a cell's face are joined. A
// *cluster* of a node is a component of the sheets in it. Clusters that are as a disc, and meet the
// node's border as a disc's border does, may each become one vertex, at different nodes of any
// size, and the surface stays a closed 2-manifold of the same topology (ClusterRules).
//
// Based on: Schaefer, Ju, Warren, "Manifold Dual Contouring", 2007 (clusters, their Euler number,
// crossings on the faces' edges). Where it differs: rules 2 and 4, and of rule 3 that not all faces
// may have none, are not there, and without each of them meshes come out that are no manifold or of
// another topology (cluster_rules_test.cpp); shapes are put together from children by the ends of
// curves, without a look at finest cells.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "stages/contouring/cell_topology.h"
#include "stages/contouring/parameters.h"
#include "storage/types/face_curve.h"
#include "storage/types/morton.h"

namespace voxweld {

// The clusters of a node that meet its border, in the order of their first finest cells and sheets.
struct NodeShape {
  std::span<const std::int32_t> euler;  // of each: sheets - arcs + crossings inside the node
  std::span<const FaceCurve> curves;    // by face, then by lower end
  std::span<const CurvePair> pairs;     // ascending
};

// Whether a node of this level is blocked, and all above it (SealingLimits).
bool is_sealed(int level, const NodeShape& shape, const SealingLimits& limits);

// When a cluster may become a vertex. Each rule can be left out, to show what comes of it.
struct ClusterRules {
  bool disc = true;            // 1: its Euler number is 1
  bool edge_once = true;       // 2: it crosses each of the node's 12 edges once at most
  bool face_twice = true;      // 3: of a face it crosses no or two edges,
  bool some_edge = true;       //    and of the node some
  bool one_arc_a_face = true;  // 4: no ambiguous finest face on the border has both arcs in it
};

class ShapeMerger {
 public:
  explicit ShapeMerger(const ClusterRules& rules = {}) : rules_(rules) {}

  // The node of children that are added next; those that are not have no surface.
  void begin(CellKey node);
  // Of a finest cell that the surface crosses, and of any other node one level below. The shape's
  // spans live until merge().
  void add_cell(int octant, CellSigns signs, bool joined);
  void add(int octant, const NodeShape& child);
  // std::logic_error where children do not fit together.
  void merge();

  // Of the node, until begin().
  NodeShape shape() const { return {euler_, curves_, pairs_}; }
  // Which of its clusters may become a vertex.
  bool may_collapse(std::size_t cluster) const { return allowed_[cluster] != 0; }
  // Its cluster that holds the children's, these counted on from child to child by octant; none
  // where they are a whole component of the surface, that meets no face of the node.
  std::span<const std::uint32_t> cluster_of() const { return cluster_of_; }
  // Whether some of these are in none.
  bool closes() const { return closes_; }

 private:
  struct Child {
    std::uint32_t first_cluster = 0;  // of the children's
    std::uint32_t first_curve = 0;
    NodeShape shape;
    std::array<std::uint32_t, 7> face_begin{};  // of its curves
  };
  struct Joint {
    Crossing at;
    std::uint32_t curve = 0;  // of the children's
    friend constexpr auto operator<=>(const Joint&, const Joint&) = default;
  };

  struct OnFace {
    FaceCurve curve;
    std::uint32_t number = 0;  // of the children's curves
    std::uint32_t first_cluster = 0;
  };
  struct Tally {
    std::array<std::uint8_t, 12> ends{};   // on each edge; each crossing is the end of two curves
    std::array<std::uint8_t, 6> curves{};  // on each face, closed ones apart
  };

  std::uint32_t root(std::uint32_t cluster);
  void unite(std::uint32_t a, std::uint32_t b);
  void join_across(int axis, int octant);
  void join_inside();
  void number_clusters();
  void gather_face(int face);
  void chain_curves(int axis);
  void chain_face(int face);
  void add_chains(std::uint32_t begin);
  void map_pairs(int face);
  void apply_rules();
  int edge_of(Crossing end) const;
  // On the line through the middle of the face with this normal.
  bool at_middle(Crossing end, int normal) const {
    const int other = 3 - normal - end.axis();
    return end[other] == planes_[1][other];
  }

  ClusterRules rules_;
  CellKey node_;
  std::array<Index3, 3> planes_;  // low, middle and high lattice point
  std::array<Child, 8> children_;
  unsigned octants_ = 0;
  bool has_pairs_ = false;  // some child
  std::array<std::array<FaceCurve, 12>, 8> cell_curves_;
  std::array<std::array<CurvePair, 6>, 8> cell_pairs_;

  // Of the children's clusters and curves, counted on from child to child.
  std::vector<std::uint32_t> parent_;
  std::vector<std::int32_t> child_euler_;
  std::vector<std::uint32_t> ends_inside_;  // on the six edges inside the node: four a crossing
  std::vector<std::uint32_t> new_curve_;
  std::vector<std::uint32_t> cluster_of_;
  std::vector<OnFace> on_face_;  // of the face at hand
  std::vector<Joint> joints_;
  std::vector<std::uint32_t> chain_;  // joined curves of one face

  std::vector<std::int32_t> euler_;
  std::vector<FaceCurve> curves_;
  std::vector<CurvePair> pairs_;
  std::vector<std::uint32_t> ends_of_cluster_;
  std::vector<Tally> tallies_;
  std::vector<std::uint8_t> allowed_;
  bool closes_ = false;
};

}  // namespace voxweld
