// Triangles cut into the fragments of Neuroglancer's multi-resolution meshes.
//
// A fragment is a cube of a lattice of cubes; at level of detail k its side is `chunk` lattice steps
// times 2^k. Positions in it are whole numbers q from 0 to 65535, so that 65535 in one fragment is 0
// in the next. `grid` coordinates are these numbers, counted on from fragment to fragment:
//
//     fragment       0                          1
//     q              0 ......... 32768 .. 65535
//                                         0 ......... 32768 ...
//     grid           0          32768     65535      98303
//
// Corners of triangles are put on the grid first. At level 0 that is exact, since `chunk` divides
// 65535; at level k a corner moves by at most 2^k / 65535 of half a chunk on each axis. Then triangles are
// cut along planes between fragments, and above level 0 also along those between the eight octants of
// a fragment, which the format puts at q = 32768. Where an edge meets a plane depends on the edge's ends
// alone, in an order of their own, and is rounded to the grid. So whoever has the edge cuts it in the same
// points, and no crack opens.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "storage/types/output_lattice.h"

namespace voxweld {

inline constexpr int fragment_bits = 16;                // of q
inline constexpr std::int64_t fragment_range = 65535;   // q of a fragment's far side
inline constexpr std::int64_t fragment_middle = 32768;  // where octants meet, as clients have it
// The sides of a fragment at level 0, in lattice steps, that keep corners exact; falling. Without 1: a
// lattice of 22 bits would have more fragments a side than a Morton code holds.
inline constexpr std::array<std::int32_t, 15> fragment_chunks{
    65535, 21845, 13107, 4369, 3855, 1285, 771, 257, 255, 85, 51, 17, 15, 5, 3};

using GridPoint = std::array<std::int64_t, 3>;

struct FragmentGrid {
  std::int32_t chunk = 65535;  // one of fragment_chunks
  int lod = 0;

  std::int64_t of(std::int32_t p) const {
    const std::int64_t fine = std::int64_t{p} * (fragment_range / chunk);
    return lod == 0 ? fine : (fine + (std::int64_t{1} << (lod - 1))) >> lod;
  }
  GridPoint of(const LatticePoint& p) const { return {of(p[0]), of(p[1]), of(p[2])}; }
};

using FragmentCell = std::array<std::uint32_t, 3>;
// The corners of a triangle in its fragment.
using FragmentTriangle = std::array<std::array<std::uint16_t, 3>, 3>;

class FragmentCutter {
 public:
  explicit FragmentCutter(FragmentGrid grid) : grid_(grid) {}

  struct Piece {
    FragmentCell cell;
    FragmentTriangle corners;
  };
  // The pieces of a triangle, whose corners are not below 0 anywhere: none has two equal corners. Their
  // edges along the triangle's own are the same for both triangles of an edge; the sum of their oriented
  // edges is that of the triangle's. Valid until the next call.
  std::span<const Piece> cut(const std::array<LatticePoint, 3>& corners);

 private:
  using Ring = std::vector<GridPoint>;

  std::int64_t slab_of(std::int64_t v) const;
  std::int64_t plane(std::int64_t slab) const;
  struct Slabs {
    std::int64_t first = 0, last = 0;
  };
  Slabs slabs(std::span<const GridPoint> ring, std::size_t axis) const;
  std::uint32_t cell_of(std::int64_t slab) const;
  bool cut_whole(const std::array<GridPoint, 3>& corners);
  void cut_along(Ring ring, std::size_t axis, std::array<std::int64_t, 3> slab);
  void cut_apart(const Ring& ring, std::size_t axis, std::array<std::int64_t, 3> slab);
  void finish(Ring& ring, const std::array<std::int64_t, 3>& slab);
  void emit(const GridPoint& a, const GridPoint& b, const GridPoint& c, const FragmentCell& cell);

  FragmentGrid grid_;
  std::vector<Piece> pieces_;
};

// Where the triangles of a fragment lie among its eight octants, by the rule of clients: bit x + 2 y + 4 z.
std::uint8_t octant_of(const FragmentTriangle& corners);
// Whether it lies in none of them.
bool crosses_octants(const FragmentTriangle& corners);

}  // namespace voxweld
