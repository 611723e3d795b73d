// One surface of a brick before it is contoured: the sides of its lattice points and the crossings
// of its edges, as the volume has them and as edits change them.
//
// Based on: Ju, Losasso, Schaefer, Warren, "Dual Contouring of Hermite Data", 2002, section 2.3
// (constructive solid geometry).
#pragma once

#include <array>
#include <span>

#include "stages/build/hermite.h"
#include "stages/build/label_field.h"
#include "stages/build/sign_grid.h"
#include "stages/contouring/parameters.h"
#include "storage/types/halo_block.h"

namespace voxweld {

// What of a brick has to be looked at when all inside samples lie in a box: the cells with a corner
// there, and the samples that crossings and normals are made of.
struct BrickWindow {
  Index3 origin;  // lattice point of the brick's lowest corner
  int side = 0;   // cells
  Box3 samples;   // the box
  Box3 cells;     // relative to the brick, may reach beyond it
  BrickWindow(Index3 brick, int cells_a_side, const Box3& extent)
      : origin(brick),
        side(cells_a_side),
        samples(extent),  // lattice point u is sample u - 1; a cell reaches one point up
        cells{extent.lo - brick, extent.hi + splat(1) - brick} {}
  // Wherever its signs are looked at: solids may lie anywhere.
  static BrickWindow everywhere(Index3 brick, int cells_a_side) {
    return {brick, cells_a_side, {brick - splat(2), brick + splat(cells_a_side + 1)}};
  }
};

// The sides of the solids of a brick's edits: for several surfaces of the brick they are found
// once, those of the first edits.
class SolidSides {
 public:
  // The edits live as long as they are asked for. frame.size: the volume's.
  void begin(std::span<const Edit* const> edits, const VolumeFrame& frame, Index3 brick, int side);
  // Of edits[i]; lives until the next call.
  const SignGrid& of(std::size_t i);

  static constexpr std::size_t most_kept = 8;

 private:
  std::span<const Edit* const> edits_;
  VolumeFrame frame_;
  Index3 brick_;
  int side_ = 0;
  std::array<SignGrid, most_kept> kept_;
  std::array<bool, most_kept> known_{};
  SignGrid other_;
};

class BrickSurface {
 public:
  const SignGrid& signs() const { return signs_; }
  const HermiteEdges& edges() const { return edges_; }

  // Gives the crossings' memory back.
  void free_edges() {
    edges_ = {};
    edges_before_ = {};
    common_edges_ = {};
  }

  // Of the volume: first the sides, then the crossings.
  // Precondition: as build_brick.
  void find_signs(const HaloBlock& block, const BrickWindow& window,
                  const SurfaceParameters& surface) {
    signs_.fill(block, window.origin, window.side, surface, window.samples);
  }
  void find_edges(const HaloBlock& block, const BrickWindow& window,
                  const ContourParameters& parameters);

  // What add, subtract or intersect makes of it, crossings included. solid: the sides of the
  // edit's, in the same brick.
  void apply(const Edit& edit, const SignGrid& solid, const VolumeFrame& frame,
             const BrickWindow& window);
  // What is in both the other and the edit's solid comes in. All are of the same brick.
  void add_common(const BrickSurface& other, const Edit& edit, const SignGrid& solid,
                  const VolumeFrame& frame, const BrickWindow& window);

 private:
  SignGrid signs_, common_signs_;
  HermiteEdges edges_, edges_before_, common_edges_;
  LabelField label_;
};

}  // namespace voxweld
