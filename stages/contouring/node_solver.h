// QEFs of octree nodes, eight at a time: from planes, from children, and their minimisers. The one
// place that decides whether a node collapses, used inside bricks (build) and above them (merge),
// so that both give the same bits.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "stages/contouring/parameters.h"
#include "stages/contouring/qef.h"

namespace voxweld {

// One Hermite datum as a QEF row takes it.
struct HermitePlane {
  std::array<double, 3> normal{};  // unit, outward
  std::array<double, 3>
      point{};     // relative to the node's centre, index units scaled by the spacing
  int weight = 1;  // how many of the node's cells have the edge: 1, 2 or 4
};

struct NodeSolution {
  // From the node's centre. Inside the node, but for the overhang of finest cells; and no further than
  // a cell from those that its planes are of.
  std::array<float, 3> offset{};
  float residual = 0;  // metric rms: root mean square distance; sum: root of the sum
};

class NodeSolver {
 public:
  explicit NodeSolver(const ContourParameters& parameters);

  // A batch of finest cells, or of nodes of whose finest cells set_extent says which the planes are of: up
  // to max_planes a lane.
  void clear_planes();
  void set_planes(std::size_t lane, std::span<const HermitePlane> planes);
  PlaneBatch& planes() { return planes_; }  // to fill for all lanes at once
  void set_extent(std::size_t lane, const CellExtent& extent) { extents_[lane] = extent; }
  void reduce();  // planes -> factors

  // A batch of nodes to merge from children of level `child_level`: up to eight a lane, set in the
  // order of octants, each once.
  void clear_children();
  void set_child(std::size_t lane, int octant, const Qef& child);
  void merge(int child_level);  // children -> factors
  // The same of up to eight QEFs a lane that all have the node's own centre.
  void set_part(std::size_t lane, const Qef& part);
  void merge_in_place();

  void load(std::size_t lane, const Qef& qef);  // a stored QEF -> factor

  // Factors -> minimisers inside nodes of this level; only the lanes below `count` count.
  void solve(int level, std::size_t count);
  Qef qef(std::size_t lane) const {
    Qef qef = store_lane(factors_, lane);
    qef.extent = extents_[lane];
    return qef;
  }
  NodeSolution solution(std::size_t lane) const;

  // With qef = "normal" sums are in the volume's coordinates: each lane's node centre there. The QR
  // form has no use for it.
  bool needs_centres() const { return parameters_.simplify.qef == QefForm::normal; }
  void set_centre(std::size_t lane, Vec3 centre) { centres_[lane] = centre; }

  bool within_tolerance(const NodeSolution& solution) const {
    return static_cast<double>(solution.residual) <= parameters_.simplify.tolerance;
  }

 private:
  void merge_from(Vec3 half);
  ChildValues& put(std::size_t lane, const Qef& qef);
  void find_boxes(int level);
  Vec3 half_side(int level) const {
    return parameters_.spacing * (0.5 * static_cast<double>(std::int64_t{1} << level));
  }

  ContourParameters parameters_;
  const QefKernels& kernels_;
  PlaneBatch planes_;
  ChildBatch children_;
  FactorBatch factors_;
  SolutionBatch solutions_;
  std::array<Vec3, lanes> centres_{};
  std::array<CellExtent, lanes> extents_{};
  std::array<CellExtent, lanes> of_children_{};  // of those set so far, as the node has them
  std::array<std::size_t, lanes> children_set_{};
  std::array<LaneBox, lanes> boxes_{};  // minimisers stay in them
  bool boxes_are_of_cells_ = false;
};

}  // namespace voxweld
