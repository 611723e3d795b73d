// What making a node of the tree of levels takes: the meshes of its children, and of the mesh itself
// what lies around it.
#pragma once

#include "pipeline/refine/cube_meshes.h"
#include "pipeline/stage/level_tree.h"
#include "pipeline/stage/stage_jobs.h"

namespace voxweld {

// What nodes refer to, and outlives them.
struct NodeSources {
  const LevelsJob& job;
  const LevelTree& tree;
  CubeMeshes& meshes;  // of the mesh itself
};

class NodeReads {
 public:
  NodeReads(const NodeSources& sources, std::uint64_t node);

  // Of all that the node stands for. Children need not be there: they are made of the same.
  void add_hashes(KeyHasher& key) const;
  bool children_are_there() const;
  // The most that is read, and the largest part of it. InputError where a child is missing.
  PartCounts counts() const;
  std::uint64_t largest_part_bytes() const;
  // between: called before each piece.
  RefineMesh read(const std::function<void()>& between) const;

 private:
  struct Piece {
    std::size_t artifact = 0, piece = 0;
  };
  struct Children {
    PartCounts counts;
    std::uint64_t largest = 0;
  };
  CubeRange cubes_of(CellKey cell) const;  // of the pieces that it holds
  template <class F>
  void each_piece(const CubeRange& range, F&& f) const;
  void find_own();
  void find_others();
  // f(artifact) of each child that is a node.
  template <class F>
  void each_child(F&& f) const;
  PartCounts own_counts() const;

  const NodeSources& sources_;
  const LevelNode& node_;
  const LatticeBox box_;
  std::vector<Piece> all_;     // of the mesh itself, in the node
  std::vector<Piece> own_;     // of those what no child that is a node stands for
  std::vector<Piece> others_;  // around it, of which those that leave their cube matter
};

}  // namespace voxweld
