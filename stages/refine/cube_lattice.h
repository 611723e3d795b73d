// The fixed lattice of cubes by which a mesh is refined.
//
// Cubes are of 64 cells a side (more where few triangles are asked for), whatever bricks, shards and
// tiles are. In the first pass they begin at cell 0; in the second they are shifted down by half a
// side, so that what was a border lies in the middle. What is changed in a pass lies in one cube,
// before and after; cubes are convex, so what is done in one has no part in what is done in another.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "storage/types/lattice_box.h"
#include "storage/types/lattice_frame.h"
#include "storage/types/morton.h"

namespace voxweld {

inline constexpr int refine_cube_level = 6;  // log2 of the cells a side
inline constexpr int refine_passes = 2;

struct RefineFrame : LatticeFrame {
  int level = refine_cube_level;  // of its cubes
};

// From the first samples to the last ones. Where samples lie between lattice points, to those beyond.
LatticeBox sample_box(const RefineFrame& frame);

// The level of the cubes of a mesh of which this part of its triangles is to be left: 7 or 8 where that
// is a quarter or a sixteenth, since triangles get twice or four times as long, and a cube without room
// for them could not get rid of more. vertices: as the mesh comes. A cube has no more of them than
// 2^18, were they everywhere alike, so that memory is bounded.
int target_cube_level(double part, std::uint64_t vertices, Index3 size);

class CubeLattice {
 public:
  // pass: 0 or 1; 2 is shifted by a quarter of a side, and has no code(). level: log2 of the cells a
  // side, where it is not the frame's.
  CubeLattice(const RefineFrame& frame, int pass) : CubeLattice(frame, pass, frame.level) {}
  CubeLattice(const RefineFrame& frame, int pass, int level);

  // The number of the cube a point lies in, 0 or more on each axis. Points beyond the volume's cells
  // count to the cubes at the border.
  Index3 cube_of(const LatticePoint& point) const;
  LatticeBox box(Index3 cube) const;  // of the lattice points in it
  // The same as if the volume did not end at its borders: it may begin below 0.
  LatticeBox whole(Index3 cube) const;
  // Of all cubes: the volume's cells, and at their far end as far as vertices are snapped.
  LatticeBox bounds() const;
  // Orders cubes along the Morton curve, and is what ranges of cubes are given in: of the cube
  // without the shift of whose lower border this one's middle is, at the upper border of the domain
  // the last one. So several cubes there have one code.
  std::uint64_t code(Index3 cube) const;

 private:
  std::array<std::vector<std::int32_t>, 3>
      borders_;                          // the lowest lattice coordinate of each cube, and the end
  std::array<std::int32_t, 3> sides_{};  // about how far they are apart
  // Where the first cubes would begin and the last ones end, did the volume not end there.
  std::array<std::int32_t, 3> begins_{}, ends_{};
  std::int64_t cubes_ = 1;  // unshifted ones a side of the domain
};

// Cubes with begin <= code < end.
struct CubeRange {
  std::uint64_t begin = 0, end = ~std::uint64_t{0};
  bool contains(std::uint64_t code) const { return begin <= code && code < end; }
};

// Finds the cubes of points that mostly lie in the cube of the one before.
class NearbyCubes {
 public:
  explicit NearbyCubes(const CubeLattice& cubes) : cubes_(cubes) {}

  // Whether it is not that of the point before.
  bool moves_to(const LatticePoint& point) {
    if (box_.contains(point)) return false;
    cube_ = cubes_.cube_of(point);
    box_ = cubes_.box(cube_);
    return true;
  }
  Index3 cube() const { return cube_; }

 private:
  const CubeLattice& cubes_;
  Index3 cube_;
  LatticeBox box_{{1, 1, 1}, {0, 0, 0}};  // holds nothing
};

}  // namespace voxweld
