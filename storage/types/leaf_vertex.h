// A leaf of the octree: its quadratic error function, the directions of its normals, its vertex.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "storage/types/tile_mesh.h"

namespace voxweld {

// The box around the finest cells that the planes of a QEF are of: from `lo` to the end of `hi`, in
// 256ths of its node's side. Of a node of more than 256 cells a side it is rounded outwards.
struct CellExtent {
  std::array<std::uint8_t, 3> lo{}, hi{255, 255, 255};
  std::array<std::uint8_t, 2> unused{};  // or there were padding, whose bytes are not told

  // Of no cell: for join.
  static constexpr CellExtent none() { return {{255, 255, 255}, {0, 0, 0}, {}}; }
  // Of the parent whose child of this octant it is of.
  CellExtent in_parent(int octant) const {
    CellExtent out;
    for (std::size_t a = 0; a < 3; ++a) {
      const int offset = (octant >> a & 1) * 256;
      out.lo[a] = static_cast<std::uint8_t>((offset + lo[a]) / 2);
      out.hi[a] = static_cast<std::uint8_t>((offset + hi[a]) / 2);
    }
    return out;
  }
  void join(const CellExtent& other) {
    for (std::size_t a = 0; a < 3; ++a) {
      lo[a] = std::min(lo[a], other.lo[a]);
      hi[a] = std::max(hi[a], other.hi[a]);
    }
  }
};

// A quadratic error function by its triangular factor (Ju et al. 2002, equation 3), relative to its
// node's centre in index units scaled by the spacing. Ten floats, and three for the mean of the
// crossings. The number of planes is the squared Frobenius norm of the 3x3 part.
//   | r00 r01 r02 b0 |
//   |     r11 r12 b1 |
//   |         r22 b2 |
//   |             rho|
// Under qef = "normal" the same ten floats hold A^T A (xx xy xz yy yz zz), A^T b, b^T b in the
// volume's coordinates (order: xx xy xz ax yy yz ay zz az bb).
struct Qef {
  std::array<float, 10> r{};    // r00 r01 r02 b0 r11 r12 b1 r22 b2 rho
  std::array<float, 3> mass{};  // mean of the crossings, relative to the node's centre
  CellExtent extent;
};

// outward: a normal's sense is the surface's. either: n and -n are one direction. Normals between
// labels point out of the smaller one, so where more than two labels meet a surface that goes on
// straight behind another has them on both its sides.
enum class NormalSense : std::uint32_t { outward, either };

// Sums of unit Hermite normals by direction; the unused ones are zero.
struct NormalClusters {
  std::array<std::array<float, 3>, max_clusters> sum{};
  NormalSense sense = NormalSense::outward;
};

// A leaf inside a brick: Morton code of its lowest cell, or where each sheet is one by itself of the
// first that its vertex stands for (24 bits), level (4 bits), sheet (2 bits),
// the sense of its vertex's normals (1 bit), and whether it shares its node with others (1 bit).
struct LeafCode {
  std::uint32_t bits = 0;
  static constexpr LeafCode make(std::uint32_t code, int level, int sheet) {
    return {code | static_cast<std::uint32_t>(level) << 24 |
            static_cast<std::uint32_t>(sheet) << 28};
  }
  constexpr std::uint32_t code() const { return bits & 0xffffff; }
  constexpr int level() const { return static_cast<int>(bits >> 24 & 15); }
  constexpr LeafCode with(NormalSense sense) const {
    return {bits | static_cast<std::uint32_t>(sense) << 30};
  }
  constexpr LeafCode sharing(bool shares) const {
    return {bits | static_cast<std::uint32_t>(shares) << 31};
  }
  constexpr bool shares() const { return bits >> 31 != 0; }
  constexpr int sheet() const { return static_cast<int>(bits >> 28 & 3); }
  // Whether another of the brick is of the same node.
  constexpr bool same_node(LeafCode other) const {
    return level() == other.level() && code() >> (3 * level()) == other.code() >> (3 * level());
  }
  constexpr NormalSense sense() const { return static_cast<NormalSense>(bits >> 30 & 1); }
};

struct LeafVertex {
  LeafCode leaf;
  std::array<float, 3> offset{};  // from the leaf's centre, index units scaled by the spacing
  std::array<PackedNormal, max_clusters> normals{};  // u = v = min for the unused
};
inline constexpr PackedNormal no_normal{INT16_MIN, INT16_MIN};

}  // namespace voxweld
