// Every label of a brick as a surface of its own (labels.mode = "each"): the brick's octree for
// each of them, bit for bit what build_brick makes of a volume that holds that label alone.
#pragma once

#include <functional>

#include "stages/build/label_extents.h"
#include "stages/build/material_block.h"

namespace voxweld {

// The octree of a brick that is all inside: nothing but its root.
const BrickOctree& filled_brick();

class LabelBricks {
 public:
  // Takes the samples of one or more bricks. Precondition: as build_brick, of integers.
  void fill(const HaloBlock& block, const MaterialRules& rules) { materials_.fill(block, rules); }

  // f(material, octree) for each material in the brick, ascending; where it fills the brick the
  // octree has nothing but its root. The octree lives until f returns.
  // Precondition: the samples filled last reach as far around the brick as it needs.
  void each(const BrickPlace& place, const ContourParameters& parameters,
            const std::function<void(Material, const BrickOctree&)>& f);

  // An upper bound on what it holds beside build_brick_bytes, for blocks of so many samples, each
  // of which may be of another label.
  static std::uint64_t memory_bytes(std::uint64_t samples);

 private:
  MaterialBlock materials_;
  LabelExtents extents_;
  BrickScratch scratch_;
  BrickOctree brick_;
};

}  // namespace voxweld
