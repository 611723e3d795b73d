// The labels of the lattice points of one brick, as numbers of a list of materials.
#pragma once

#include <cstdint>
#include <vector>

#include "stages/build/collapse_rule.h"
#include "stages/build/material_block.h"
#include "stages/contouring/label_topology.h"

namespace voxweld {

// Covers lattice points 0 .. side relative to the brick's lowest: the corners of its cells.
class LabelGrid : public CollapseRule {
 public:
  // brick: lattice point of the brick's lowest corner; side: cells a side. Points without a sample
  // are outside(). Precondition: `materials` was filled from a block that holds the brick's
  // samples.
  void fill(const MaterialBlock& materials, Index3 brick, int side);

  // Relative coordinates, 0 .. side.
  std::uint32_t at(int x, int y, int z) const { return row(y, z)[x]; }
  const std::uint32_t* row(int y, int z) const {
    return labels_.data() +
           (static_cast<std::size_t>(z) * points_ + static_cast<std::size_t>(y)) * points_;
  }
  CellLabels cell(int x, int y, int z) const;
  // Of the node of `node_side` cells at (x, y, z), at half its side.
  NodeLabels node(int x, int y, int z, int node_side) const;

  bool allows(int x, int y, int z, int node_side) const override {
    return labels_allow_collapse(node(x, y, z, node_side));
  }

  NodeCrossings crossings(int x, int y, int z) const override;

  void set(int x, int y, int z, std::uint32_t label) {
    labels_[(static_cast<std::size_t>(z) * points_ + static_cast<std::size_t>(y)) * points_ +
            static_cast<std::size_t>(x)] = label;
  }
  std::uint32_t outside() const { return static_cast<std::uint32_t>(materials_.size()) - 1; }
  // Precondition: it is among materials().
  std::uint32_t number_of(Material material) const;

  int side() const { return static_cast<int>(points_) - 1; }
  // What the numbers stand for: ascending, the last is `exterior`.
  const std::vector<Material>& materials() const { return materials_; }

 private:
  std::size_t points_ = 0;  // a side
  std::vector<std::uint32_t> labels_;
  std::vector<Material> materials_;
};

}  // namespace voxweld
