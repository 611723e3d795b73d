// Which pieces a rule changes, and how many these are.
#pragma once

#include <cstdint>

#include "pipeline/filter/pieces.h"
#include "stages/filter/block_pieces.h"

namespace voxweld {

// All but one change, and which one is known at the end alone.
inline bool keeps_largest(const PieceRule& rule) {
  return rule.what == PieceRule::What::keep && rule.voxels == 0;
}
inline const char* filter_name(const PieceRule& rule) {
  return rule.what == PieceRule::What::keep ? "keep" : "fill";
}
// The samples that pieces are made of.
inline SurfaceSide side_of(const PieceRule& rule) {
  return {rule.isovalue, rule.inside, rule.what == PieceRule::What::keep};
}
inline bool is_larger(const PieceFacts& a, const PieceFacts& b) {
  return a.samples != b.samples ? a.samples > b.samples : a.first < b.first;
}

struct PieceTally {
  std::uint64_t pieces = 0, changed_pieces = 0;    // fill: those that do not reach the border
  std::uint64_t samples = 0, changed_samples = 0;  // of them

  // Counts a piece that is complete. Returns whether it changes; of the largest, that it does.
  bool judge(const PieceRule& rule, const PieceFacts& piece) {
    const bool fills = rule.what == PieceRule::What::fill;
    if (fills && piece.border) return false;
    const bool changes = fills                 ? piece.samples <= rule.voxels
                         : keeps_largest(rule) ? true
                                               : piece.samples < rule.voxels;
    pieces += 1;
    samples += piece.samples;
    changed_pieces += changes ? 1 : 0;
    changed_samples += changes ? piece.samples : 0;
    return changes;
  }
  PieceTally& operator+=(const PieceTally& other) {
    pieces += other.pieces;
    changed_pieces += other.changed_pieces;
    samples += other.samples;
    changed_samples += other.changed_samples;
    return *this;
  }
};

}  // namespace voxweld
