// Crossings and normals of the lattice edges with a sign change (DESIGN: Hermite edges).
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "stages/build/hermite_edge.h"
#include "stages/build/label_grid.h"
#include "stages/build/sign_grid.h"
#include "stages/contouring/parameters.h"
#include "storage/types/halo_block.h"

namespace voxweld {

// All crossing edges of a brick's cells, upper border planes included, found by rank: a row of bits
// for each line of edges and a running count, so that no map is needed.
class HermiteEdges {
 public:
  // Halo the block must have around the brick's lattice points 0 .. side:
  // gradient_halo samples, where the volume has them.
  // where: of lattice points relative to the brick, those crossing edges may begin at; no other is
  // looked at, and the block needs to reach no further around them.
  void compute(const HaloBlock& block, Index3 brick, int side, const SignGrid& signs,
               const Box3& where, const ContourParameters& parameters);
  void compute(const HaloBlock& block, Index3 brick, int side, const SignGrid& signs,
               const ContourParameters& parameters) {
    compute(block, brick, side, signs, Box3{{}, splat(side + 1)}, parameters);
  }

  // The same of a label. field: its filtered indicator (label_field.h).
  void compute_label(const HaloBlock& field, Index3 brick, int side, const SignGrid& signs,
                     const Box3& where, Vec3 spacing);

  // Takes the edges `edits` makes: those of `before`, the same brick's without the edit, where they
  // are still on the surface, else those of the solid. signs: after the edit; solid: the solid's.
  void compute(const Edit& edit, const VolumeFrame& frame, Index3 brick, int side,
               const SignGrid& signs, const SignGrid& solid, const HermiteEdges& before);

  // Takes the edges of the union of two of the same brick: where both cross, those further out.
  // signs: of the union.
  void unite(int side, const SignGrid& signs, const HermiteEdges& a, const HermiteEdges& b);

  // Finds the edges whose ends have different labels; what datum each has is the caller's to fill
  // in.
  void find(const LabelGrid& labels);
  HermiteEdge& datum(int axis, int x, int y, int z) { return edges_[number(axis, x, y, z)]; }

  bool has(int axis, int x, int y, int z) const {
    return (bits_[word_of(axis, x, y, z)] >> (x & 63) & 1u) != 0;
  }
  // The edge along `axis` whose low end is the relative lattice point (x, y, z).
  // Precondition: it has a sign change.
  const HermiteEdge& at(int axis, int x, int y, int z) const {
    return edges_[number(axis, x, y, z)];
  }
  std::size_t size() const { return edges_.size(); }

 private:
  std::size_t word_of(int axis, int x, int y, int z) const {
    return ((static_cast<std::size_t>(axis) * points_ + static_cast<std::size_t>(z)) * points_ +
            static_cast<std::size_t>(y)) *
               row_words_ +
           static_cast<std::size_t>(x >> 6);
  }
  std::size_t number(int axis, int x, int y, int z) const {
    const std::size_t word = word_of(axis, x, y, z);
    const std::uint64_t below = (std::uint64_t{1} << (x & 63)) - 1;
    return first_[word] + static_cast<std::size_t>(std::popcount(bits_[word] & below));
  }
  void find_rows(const SignGrid& signs, int side, const Box3& where);
  void count_rows();
  // f(axis, y, z) of the rows looked at, in the order edges are kept.
  template <class F>
  void each_row(const F& f) const;
  template <class F>
  void each_edge(const F& f) const;
  template <class F>
  void fill_edges(const F& edge_of);

  std::size_t points_ = 0;  // side + 1
  std::size_t row_words_ = 0;
  Box3 window_;  // lattice points looked at: the rows of its y and z
  std::vector<std::uint64_t> bits_;
  std::vector<std::uint32_t> first_;  // edges before each word
  std::vector<HermiteEdge> edges_;
};

}  // namespace voxweld
