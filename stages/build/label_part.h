// One label of several in a brick, as a surface of its own, and what edits make of it
// (labels.mode = "each").
//
// To label m by itself an edit of labels (storage/types/solid.h) is one of a single material:
//   add        adds the solid where it gives m, and subtracts it where it gives another label
//   subtract   subtracts it
//   intersect  leaves what is in it
//   replace    subtracts it where it gives another label; where it gives m, what of the solid was
//              of any label before comes in
// So at every sample the labels are those of labels.mode = "shared", and but for replace label m is
// to the bit what surface.label = m and these edits give. What is of any label is one solid more,
// with the surface that all labels merged into one have; add adds to it, and replace leaves it.
#pragma once

#include <span>

#include "stages/build/brick_surface.h"
#include "stages/build/build_brick.h"
#include "stages/solids/solid.h"

namespace voxweld {

class LabelPart {
 public:
  // extent: before the edits the label is nowhere else, of the samples the brick's signs are read
  // from; may be empty. edits: those that reach the brick, in their order; solids: of the same.
  // Both live as long as it.
  LabelPart(Material material, const BrickPlace& place, const Box3& extent,
            std::span<const Edit* const> edits, SolidSides& solids, Vec3 spacing);

  // Whether an edit may change anything of the label.
  bool is_edited() const;
  // Whether one gives it what was of any label.
  bool replaces() const { return last_replace_ > 0; }
  // any: the brick's samples, 1 where they are of any label. Precondition: not null if replaces().
  void set_any(const HaloBlock* any) { any_ = any; }

  const BrickWindow& window() const { return window_; }

  // surface: with the label's signs; true when it was edited, and has crossings then.
  bool apply_edits(const HaloBlock& block, const ContourParameters& parameters,
                   BrickSurface& surface, BrickSurface& any) const;

 private:
  // By itself, `replace` where it gives the label.
  EditOp op_of(const Edit& edit) const;
  bool changes(const Edit& edit) const;

  Material material_;
  std::span<const Edit* const> edits_;
  SolidSides* solids_;
  BrickWindow window_;
  Bounds bounds_;                 // of the window, and a sample more
  std::size_t last_replace_ = 0;  // of edits_, counted from 1
  const HaloBlock* any_ = nullptr;
};

}  // namespace voxweld
