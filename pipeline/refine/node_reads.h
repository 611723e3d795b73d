// What making a node of the tree of levels takes: of each surface in it the meshes of its children, and of
// the mesh itself what lies around it.
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

// The children of a node that are nodes, as they are on disk.
class NodeChildren {
 public:
  NodeChildren(const NodeSources& sources, std::uint64_t node);

  bool are_there() const;
  // f(artifact) of each. InputError where one is missing.
  template <class F>
  void each(F&& f) const {
    for (std::size_t i = 0; i < paths_.size(); ++i) f(open(i));
  }

 private:
  std::shared_ptr<const CubeMeshArtifact> open(std::size_t child) const;

  std::string of_;  // the node
  std::vector<std::filesystem::path> paths_;
  mutable BoundedCache<CubeMeshArtifact> open_{8};
};

class NodeReads {
 public:
  // children: of the node; they outlive it.
  NodeReads(const NodeSources& sources, std::uint64_t node, const LevelSurface& surface,
            const NodeChildren& children);

  Material label() const { return surface_.label; }
  bool all() const { return surface_.all; }
  // Of all that the node stands for. Children need not be there: they are made of the same.
  void add_hashes(KeyHasher& key) const;
  // The most that is read, and what parts of it take that are held at once. InputError where a child is
  // missing.
  PartCounts counts() const;
  std::uint64_t parts_bytes() const;
  // Samples are as thin_samples() leaves them. tolerance: of the node, in lattice steps. Threads that are free
  // help. between: called for each part, by any of them.
  RefineMesh read(double tolerance, const std::function<void()>& between) const;

 private:
  struct Piece {
    std::size_t artifact = 0, piece = 0;
  };
  struct Part;
  std::vector<Part> parts() const;
  RefineMesh read(const Part& part) const;
  CubeRange cubes_of(CellKey cell) const;  // of the pieces that it holds
  template <class F>
  void each_piece(const CubeRange& range, F&& f) const;
  void find_own();
  void find_others();
  // f(artifact, number of a piece, its record) of the surface in children that are nodes.
  template <class F>
  void each_child_piece(F&& f) const;

  const NodeSources& sources_;
  const LevelNode& node_;
  const LevelSurface& surface_;
  const NodeChildren& children_;
  const LatticeBox box_;
  std::vector<Piece> all_;     // of the mesh itself, in the node
  std::vector<Piece> own_;     // of those what no child that is a node stands for
  std::vector<Piece> others_;  // around it, of which those that leave their cube matter
};

}  // namespace voxweld
