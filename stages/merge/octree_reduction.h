// Merge: collapsing goes on above the bricks, in one streaming pass in Morton order that holds
// eight siblings a level.
//
// Based on: Ju, Losasso, Schaefer, Warren, "Dual Contouring of Hermite Data", 2002, sections 3.1
// and 4, as inside a brick (build): same solver, same test, so the same bits as one large brick
// gives.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "stages/contouring/node_solver.h"
#include "storage/types/top_tree.h"

namespace voxweld {

// Takes what is final, in Morton order.
class ReductionSink {
 public:
  virtual ~ReductionSink() = default;
  // A leaf that no node above takes in. Also those the bricks have themselves (key.level equal to
  // the brick level).
  virtual void leaf(CellKey key, const RootRecord& record) = 0;
  // A cube whose subtree is one leaf or part of one: its counts.
  virtual void cube(const CubeCount& count) = 0;
};

struct NodeSummary {
  CellKey key;
  RootRecord record;
  std::uint64_t polygons = 0;  // owned by cells below; only of nodes that are one leaf
};

class OctreeReduction {
 public:
  // root: the subtree to reduce; what lies in it and is never pushed is outside. domain_level: of
  // the octree's root; a subtree that reaches above it (a shard larger than the volume) does not
  // collapse there.
  OctreeReduction(CellKey root, int domain_level, const ContourParameters& parameters,
                  ReductionSink& sink);

  // The next node, in Morton order, not overlapping those before. When it is split, everything
  // before it has reached the sink on return: the caller passes on the node's own cubes then.
  void push(const NodeSummary& node);

  // Closes all; the root's summary. A root that is one leaf is not passed to the sink: what lies
  // above decides (call settle when nothing does).
  NodeSummary finish();
  static void settle(const NodeSummary& root, ReductionSink& sink);

  // Nodes that took in their children here.
  std::uint64_t collapsed() const { return collapsed_; }

 private:
  struct OpenNode {
    CellKey key;
    bool split = false;  // a descendant is: it cannot collapse, and its leaves are passed on
    std::array<NodeSummary, 8> children;
  };

  void open_down_to(CellKey parent);
  void close_until_holding(CellKey key);
  void add_child(const NodeSummary& node);
  NodeSummary close(OpenNode& node);
  bool corners_allow(const OpenNode& node, RootRecord& result) const;
  bool collapse(const OpenNode& node, NodeSummary& result);
  void mark_split();

  CellKey root_;
  int domain_level_;
  NodeSolver solver_;
  Vec3 spacing_;
  bool labels_;  // corners carry materials
  ReductionSink& sink_;
  std::vector<OpenNode> open_;
  NodeSummary result_;
  std::uint64_t collapsed_ = 0;
};

}  // namespace voxweld
