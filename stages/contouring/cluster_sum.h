// The clusters of a node's children that are one cluster of the node, added up: the one way to do
// it, inside bricks and above them.
#pragma once

#include "stages/contouring/node_solver.h"
#include "stages/contouring/normal_clusters.h"

namespace voxweld {

class ClusterSum {
 public:
  explicit ClusterSum(const ContourParameters& parameters) : octant_solver_(parameters) {}

  // A cluster of the node, to be solved in this lane. The solver outlives it.
  void begin(NodeSolver& solver, std::size_t lane) {
    solver_ = &solver;
    lane_ = lane;
    octant_ = -1;
    normals_ = {};
  }
  // Of the children by octant, and of each in the order of its clusters. centre: of the child's
  // node; not looked at unless solvers need centres.
  void add(int octant, const Qef& qef, const NormalClusters& normals, Vec3 centre) {
    if (octant == octant_) return add_up(qef, normals, centre);
    close_octant();
    octant_ = octant;
    of_octant_ = {qef, normals};
  }
  // The node's QEF is the solver's to merge then.
  NormalClusters finish() {
    close_octant();
    return normals_.merged();
  }

 private:
  struct Part {
    Qef qef;
    NormalClusters normals;
  };
  void close_octant() {
    if (octant_ < 0) return;
    solver_->set_child(lane_, octant_, of_octant_.qef);
    normals_.add(of_octant_.normals);
  }
  // Several of one child: they are relative to the same centre.
  void add_up(const Qef& qef, const NormalClusters& normals, Vec3 centre) {
    octant_solver_.set_centre(0, centre);
    octant_solver_.clear_children();
    octant_solver_.set_part(0, of_octant_.qef);
    octant_solver_.set_part(0, qef);
    octant_solver_.merge_in_place();
    ClusterMerge both;
    both.add(of_octant_.normals);
    both.add(normals);
    of_octant_ = {octant_solver_.qef(0), both.merged()};
  }

  NodeSolver octant_solver_;
  NodeSolver* solver_ = nullptr;
  std::size_t lane_ = 0;
  int octant_ = -1;
  Part of_octant_;
  ClusterMerge normals_;
};

}  // namespace voxweld
