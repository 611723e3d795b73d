// The tiles of coarser levels of detail, as a tree above the tiles of the mesh itself.
//
// A node is a cube of the octree that holds several tiles or nodes, and stands for all of them. Where a
// cube would hold one alone there is no node. So levels differ from place to place: a node's height is
// one more than the greatest among its children, and at level k the mesh is made of the highest nodes
// of no more than that height, and of tiles that are in none.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "storage/support/hash.h"
#include "storage/types/top_tree.h"

namespace voxweld {

struct LevelNode {
  CellKey cell;                      // at least as large as a cube of refine
  int height = 1;                    // above tiles, whose height is 0
  bool all = false;                  // it holds all tiles
  std::vector<std::uint64_t> nodes;  // children that are nodes, by their numbers, in Morton order
  std::vector<std::uint64_t> tiles;  // and those that are tiles, by theirs

  std::string name() const;  // "1/7-0-1-0": height, level and index, the same in every run
  friend bool operator==(const LevelNode&, const LevelNode&) = default;
};

class LevelTree {
 public:
  LevelTree() = default;
  // tiles: cubes that do not overlap, in Morton order. levels: how many there are to be, the tiles among
  // them; 0: until one node holds all. Where more are asked for than that, further nodes have the
  // same cube. least: the smallest level of a node's cell.
  LevelTree(std::span<const CellKey> tiles, std::int64_t levels, int least);

  // By height, then in Morton order: children before their parents.
  const std::vector<LevelNode>& nodes() const { return nodes_; }
  // Of each height from 1 on, the number behind its last node.
  const std::vector<std::uint64_t>& ends() const { return ends_; }
  // Tiles and nodes.
  std::uint64_t size() const { return tiles_.size() + nodes_.size(); }
  int top() const { return static_cast<int>(ends_.size()); }  // the greatest height
  CellKey tile(std::uint64_t number) const { return tiles_[number]; }
  // What no node holds.
  std::vector<std::uint64_t> root_nodes() const;
  std::vector<std::uint64_t> root_tiles() const;
  // What the mesh is made of at a level: f(number of a node), g(number of a tile).
  template <class Node, class Tile>
  void cut(int height, Node&& f, Tile&& g) const {
    for (std::uint64_t n = 0; n < nodes_.size(); ++n)
      if (nodes_[n].height <= height &&
          (parents_[n] == none || nodes_[parents_[n]].height > height))
        f(n);
    for (std::uint64_t t = 0; t < tile_parents_.size(); ++t)
      if (tile_parents_[t] == none || nodes_[tile_parents_[t]].height > height) g(t);
  }
  // Of the cubes of all that it holds, and how they hold each other.
  void add_shape(KeyHasher& key, std::uint64_t node) const;

 private:
  static constexpr std::uint64_t none = ~std::uint64_t{0};

  std::vector<CellKey> tiles_;
  std::vector<LevelNode> nodes_;
  std::vector<std::uint64_t> ends_;
  std::vector<std::uint64_t> parents_, tile_parents_;
};

// Where a node's mesh is, and how its files begin.
std::filesystem::path level_artifact_path(const std::filesystem::path& folder,
                                          const LevelNode& node);
std::filesystem::path level_record_path(const std::filesystem::path& folder, const LevelNode& node);
inline constexpr const char* levels_folder = "levels";  // of the output directory
std::string level_stem(const LevelNode& node);          // relative to it, without an ending

}  // namespace voxweld
