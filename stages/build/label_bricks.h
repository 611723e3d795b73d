// Every label of a brick as a surface of its own (labels.mode = "each"): the brick's octree for
// each of them, bit for bit what build_brick makes of a volume that holds that label alone.
#pragma once

#include <functional>

#include "stages/build/label_extents.h"
#include "stages/build/label_part.h"
#include "stages/build/material_block.h"

namespace voxweld {

// The octree of a brick that is all inside: nothing but its root.
const BrickOctree& filled_brick();

class LabelBricks {
 public:
  // Takes the samples of one or more bricks. Precondition: as build_brick, of integers;
  // parameters.labels.rules are not null.
  void fill(const HaloBlock& block, const ContourParameters& parameters);

  // f(material, octree) for each material in the brick or that an edit may give there, ascending;
  // where it fills the brick, or is not in it, the octree has nothing but its root. The octree
  // lives until f returns. Precondition: the samples filled last reach as far around the brick as
  // it needs; the parameters are those they were filled with.
  void each(const BrickPlace& place, const ContourParameters& parameters,
            const std::function<void(Material, const BrickOctree&)>& f);

  // As those of BrickScratch.
  void set_reserve(std::function<void(std::uint64_t)> reserve) {
    scratch_.reserve = std::move(reserve);
  }
  void free_buffers() {
    scratch_.free_buffers();
    brick_ = {};
  }

  // An upper bound on what it holds beside build_brick_bytes, for blocks of so many samples, each
  // of which may be of another label.
  static std::uint64_t memory_bytes(std::uint64_t samples);

 private:
  // Of the numbers of materials_, ascending: those in the brick, and those that edits give there.
  void find_labels(const BrickPlace& place, const ContourParameters& parameters);

  MaterialBlock materials_;
  LabelExtents extents_;
  std::vector<Material> given_;     // by edits
  std::vector<const Edit*> edits_;  // that reach the brick
  SolidSides solids_;               // of those
  struct Label {
    std::uint32_t number = 0;
    bool found = false;  // in the brick's samples
  };
  std::vector<Label> labels_;
  BrickScratch scratch_;
  BrickOctree brick_;
};

}  // namespace voxweld
