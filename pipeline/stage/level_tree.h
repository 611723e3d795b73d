// The tiles of coarser levels of detail, as a tree above the meshes of the finest one: its leaves.
//
// A leaf is a tile of the mesh, or with labels.mode = "each" one of a label. A node is a cube of the
// octree with several leaves or nodes in it, and stands for all of them, whatever their labels are. Where
// a cube would hold one alone there is no node; nor where parts of labels are few enough for one tile. So
// levels differ from place to place: a node's height is one more than the greatest among its children, and
// at level k the mesh is made of the highest nodes of no more than that height, and of leaves that are in
// none.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "storage/support/hash.h"
#include "storage/types/material.h"
#include "storage/types/top_tree.h"

namespace voxweld {

struct LevelLeaf {
  // The tile. Of a label in one tile, whose mesh may lie across any cubes, a cube around its middle.
  CellKey place;
  std::uint64_t vertices = 0;
  Material label = sole_material;
  bool whole = false;  // a label in one tile
};

struct LevelNode {
  CellKey cell;                       // at least as large as a cube of refine
  int height = 1;                     // above leaves, whose height is 0
  int doublings = 2;                  // of the mesh's tolerance, to that of the node
  bool all = false;                   // it holds all leaves
  std::vector<std::uint64_t> nodes;   // children that are nodes, by their numbers, in Morton order
  std::vector<std::uint64_t> leaves;  // and those that are leaves, by theirs, by place

  std::string name() const;  // "1/7-0-1-0": height, level and index, the same in every run
  friend bool operator==(const LevelNode&, const LevelNode&) = default;
};

// What a node holds of a surface: of the only one, or of a label's.
struct LevelSurface {
  Material label = sole_material;
  bool all = false;                   // all of its leaves
  std::vector<std::uint64_t> leaves;  // those that are the node's own children, by number
};

struct LevelTreeRules {
  // How many levels there are to be, leaves among them; 0: until one node holds all. Where more are asked
  // for than that, further nodes have the same cube.
  std::int64_t levels = 0;
  int least = 0;  // the smallest level of a node's cell
  // A cube with no more vertices needs no node: what stands for its leaves is put together in a larger one.
  // So there are not many levels where labels are large and lie around each other. 0: every cube needs one.
  std::uint64_t few_vertices = 0;
  bool of_labels = false;
  // Where a node would have more with four times its children's tolerance, it gets eight times that, as long as it
  // is no more than a 64th of the cell's side, a few pixels of a picture. Through a volume full of surface, tiles
  // twice as wide with edges twice as long have twice as many triangles: these grew from level to level until
  // they fit no memory. 0: any number.
  std::uint64_t most_vertices = 0;
  double tolerance = 0;  // of the mesh, in sides of finest cells
};

class LevelTree {
 public:
  LevelTree() = default;
  // leaves: by label, and of one label by Morton code, in cubes that do not overlap.
  LevelTree(std::vector<LevelLeaf> leaves, const LevelTreeRules& rules);

  // By height, then in Morton order: children before their parents.
  const std::vector<LevelNode>& nodes() const { return nodes_; }
  // Of each height from 1 on, the number behind its last node.
  const std::vector<std::uint64_t>& ends() const { return ends_; }
  const std::vector<LevelLeaf>& leaves() const { return leaves_; }
  bool of_labels() const { return of_labels_; }
  int top() const { return static_cast<int>(ends_.size()); }  // the greatest height
  // What no node holds.
  std::vector<std::uint64_t> root_nodes() const;
  std::vector<std::uint64_t> root_leaves() const;
  // What the node stands for, by label.
  std::vector<LevelSurface> surfaces(std::uint64_t node) const;
  // What the mesh is made of at a level: f(number of a node), g(number of a leaf).
  template <class Node, class Leaf>
  void cut(int height, Node&& f, Leaf&& g) const {
    for (std::uint64_t n = 0; n < nodes_.size(); ++n)
      if (nodes_[n].height <= height &&
          (parents_[n] == none || nodes_[parents_[n]].height > height))
        f(n);
    for (std::uint64_t t = 0; t < leaf_parents_.size(); ++t)
      if (leaf_parents_[t] == none || nodes_[leaf_parents_[t]].height > height) g(t);
  }
  // Of the cubes of all that it holds, and how they hold each other.
  void add_shape(KeyHasher& key, std::uint64_t node) const;
  std::uint64_t bytes() const;  // that it takes in memory, about

 private:
  static constexpr std::uint64_t none = ~std::uint64_t{0};

  std::vector<std::uint64_t> all_leaves(std::uint64_t node) const;  // by number
  void take(std::vector<LevelNode> built, std::int64_t levels);
  void mark_whole();

  std::vector<LevelLeaf> leaves_;
  bool of_labels_ = false;
  std::vector<LevelNode> nodes_;
  std::vector<std::uint64_t> ends_;
  std::vector<std::uint64_t> parents_, leaf_parents_;
};

// Where a node's mesh is, and how its files begin.
std::filesystem::path level_artifact_path(const std::filesystem::path& folder,
                                          const LevelNode& node);
std::filesystem::path level_record_path(const std::filesystem::path& folder, const LevelNode& node);
inline constexpr const char* levels_folder = "levels";  // of the output directory
std::string level_stem(const LevelNode& node);          // relative to it, without an ending

}  // namespace voxweld
