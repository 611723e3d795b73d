// Octree cells as types. Level 0 is the finest; a cell of level l is the cube of 2^l lattice cells
// a side whose index, shifted right by l, is `at`. Morton codes interleave x (lowest bit), y, z.
#pragma once

#include <compare>
#include <cstdint>

#include "storage/types/box.h"

namespace voxweld {

namespace morton_detail {
constexpr std::uint64_t spread(std::uint64_t v) {  // 21 bits to every third bit
  v &= 0x1fffff;
  v = (v | v << 32) & 0x1f00000000ffffULL;
  v = (v | v << 16) & 0x1f0000ff0000ffULL;
  v = (v | v << 8) & 0x100f00f00f00f00fULL;
  v = (v | v << 4) & 0x10c30c30c30c30c3ULL;
  v = (v | v << 2) & 0x1249249249249249ULL;
  return v;
}
constexpr std::uint64_t gather(std::uint64_t v) {
  v &= 0x1249249249249249ULL;
  v = (v | v >> 2) & 0x10c30c30c30c30c3ULL;
  v = (v | v >> 4) & 0x100f00f00f00f00fULL;
  v = (v | v >> 8) & 0x1f0000ff0000ffULL;
  v = (v | v >> 16) & 0x1f00000000ffffULL;
  v = (v | v >> 32) & 0x1fffffULL;
  return v;
}
}  // namespace morton_detail

// Precondition: 0 <= p < 2^21 on each axis.
constexpr std::uint64_t morton_encode(Index3 p) {
  return morton_detail::spread(static_cast<std::uint64_t>(p.x)) |
         morton_detail::spread(static_cast<std::uint64_t>(p.y)) << 1 |
         morton_detail::spread(static_cast<std::uint64_t>(p.z)) << 2;
}
constexpr Index3 morton_decode(std::uint64_t code) {
  return {static_cast<std::int64_t>(morton_detail::gather(code)),
          static_cast<std::int64_t>(morton_detail::gather(code >> 1)),
          static_cast<std::int64_t>(morton_detail::gather(code >> 2))};
}

struct CellKey {
  int level = 0;
  Index3 at;  // in units of 2^level lattice cells

  static constexpr CellKey of(std::uint64_t code, std::uint64_t level) {  // code: as code()
    return {static_cast<int>(level), morton_decode(code >> (3 * level))};
  }
  constexpr std::int64_t side() const { return std::int64_t{1} << level; }
  constexpr Index3 lo() const { return at * side(); }  // lowest lattice point
  constexpr Box3 cells() const { return {lo(), lo() + splat(side())}; }
  // Morton code of the lowest finest cell inside: orders cells of all levels along the curve.
  constexpr std::uint64_t code() const { return morton_encode(lo()); }
  constexpr CellKey parent() const { return {level + 1, {at.x >> 1, at.y >> 1, at.z >> 1}}; }
  constexpr CellKey child(int octant) const {
    return {level - 1,
            {at.x * 2 + (octant & 1), at.y * 2 + (octant >> 1 & 1), at.z * 2 + (octant >> 2)}};
  }
  // The child that holds a smaller cell. Precondition: this cell does.
  constexpr int octant_of(const CellKey& inner) const {
    const int shift = level - 1 - inner.level;
    return static_cast<int>((inner.at.x >> shift & 1) | (inner.at.y >> shift & 1) << 1 |
                            (inner.at.z >> shift & 1) << 2);
  }
  friend constexpr bool operator==(const CellKey&, const CellKey&) = default;
};

// The smallest L with 2^L >= max(size) + 1: the level of the root of a volume's octree, whatever
// the brick size. size: samples a side.
constexpr int domain_level(Index3 size) {
  const std::int64_t cells = std::max({size.x, size.y, size.z}) + 1;
  int level = 0;
  while ((std::int64_t{1} << level) < cells) ++level;
  return level;
}

// The id of a vertex: the level of its node, and the first finest cell and sheet that it stands for;
// where a node has one vertex for all that is in it, its lowest cell. The same in every partition.
// Layout: level (5 bits) | Morton code of the finest cell (57 bits) | sheet (2 bits).
struct VertexId {
  std::uint64_t bits = 0;

  static constexpr VertexId make(int level, std::uint64_t code, int sheet) {
    return {static_cast<std::uint64_t>(level) << 59 | code << 2 |
            static_cast<std::uint64_t>(sheet)};
  }
  static constexpr VertexId make(CellKey leaf, int sheet) {
    return make(leaf.level, leaf.code(), sheet);
  }
  constexpr int level() const { return static_cast<int>(bits >> 59); }
  constexpr int sheet() const { return static_cast<int>(bits & 3); }
  constexpr CellKey leaf() const {
    return CellKey::of(bits >> 2 & ((std::uint64_t{1} << 57) - 1), bits >> 59);
  }
  friend constexpr auto operator<=>(VertexId, VertexId) = default;
};
// 57 bits: 19 an axis, so a domain of 2^19 cells a side at level 0.
inline constexpr int max_levels = 19;

}  // namespace voxweld
