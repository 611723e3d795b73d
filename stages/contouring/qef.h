// Quadratic error functions kept by their triangular factor, merged up the octree without ever
// forming A^T A.
//
// Based on: Ju, Losasso, Schaefer, Warren, "Dual Contouring of Hermite Data", 2002 (QR
// representation and merging); Householder, "Unitary Triangularization of a Nonsymmetric Matrix",
// 1958 (a column at a time, where the former rotates a row at a time); Lindstrom, "Out-of-Core Simplification of Large Polygonal
// Models", 2000 (truncated SVD about the mass point); Hestenes, "Inversion of Matrices by
// Biorthogonalization", 1958 (one-sided Jacobi). Where it differs: each QEF is relative to its own
// node's centre (DESIGN: QR QEF), so that floats are enough at any volume size; a minimiser outside
// the cell is replaced by the constrained one (qef.cpp), not clamped.
//
// Everything is computed in double, in eight lanes, by + - * / and sqrt alone: lane by lane the
// same bits on every vector unit. Results are rounded to float once, on storing.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "stages/contouring/lanes.h"
#include "storage/types/box.h"
#include "storage/types/brick_octree.h"

namespace voxweld {

// Of the edges of a node of 2^3 cells; of a finest cell 12.
inline constexpr std::size_t max_planes = 54;

// Planes to reduce for each lane, n . x = n . p with p relative to the node's centre. Rows that a lane
// has not must be zero, as far as `rows` and three at least.
struct alignas(64) PlaneBatch {
  int rows = 0;                                              // the longest lane
  std::array<std::array<LaneArray, 4>, max_planes> plane{};  // nx ny nz n.p
  std::array<LaneArray, 3> mass{};                           // mean of the crossings
};

// Of one child in each lane: Qef::r, Qef::mass, and where its centre lies from the parent's, in halves
// of its side: -1 or 1 an axis, or 0. All zero where the lane has none.
using ChildValues = std::array<std::array<float, lanes>, 16>;

// Children to merge, each lane's one after the other from the first slot on, in the order of octants.
struct alignas(64) ChildBatch {
  std::size_t slots = 0;  // of the longest lane; those behind hold anything, but for the first
  std::array<ChildValues, 8> child{};
};

// A factor in double: r as in Qef, n the number of planes (squared Frobenius norm).
struct alignas(64) FactorBatch {
  std::array<LaneArray, 10> r{};
  std::array<LaneArray, 3> mass{};
  LaneArray planes{};
};

struct alignas(64) SolutionBatch {
  std::array<LaneArray, 3> x{};  // relative to the node's centre
  LaneArray energy{};            // sum of squared distances to the planes, at x
};

// Relative to the node's centre.
struct LaneBox {
  std::array<double, 3> lo{}, hi{};
  bool contains(int axis, double x) const {
    const auto a = static_cast<std::size_t>(axis);
    return lo[a] <= x && x <= hi[a];
  }
  double clamp(int axis, double x) const {
    const auto a = static_cast<std::size_t>(axis);
    return std::clamp(x, lo[a], hi[a]);
  }
};

// One lane of a factor, and the box its minimiser is to lie in. cut: squared, below which a singular value
// counts for nothing.
struct BoxedFactor {
  std::array<double, 10> r{};
  std::array<double, 3> mass{};
  LaneBox box;
  double cut = 0;
};

// Minimisers over the faces of a box, and over its edges, in three batches: of the faces, low and high of
// each axis, in the first six lanes; of the four edges along x and of those along y; and of those along z, in
// the first four. What other lanes have is of no meaning.
struct alignas(64) BorderPoints {
  std::array<std::array<LaneArray, 3>, 3> x{};  // of each batch
  std::array<LaneArray, 3> energy{};
  std::array<LaneArray, 3> from_mass{};  // squared distance from the mass point
  std::array<std::array<std::int64_t, lanes>, 3>
      in_box{};  // 0: outside, which those of faces may be
};

struct QefKernels {
  void (*reduce)(const PlaneBatch&, FactorBatch&);
  // half: half the child's side on each axis, scaled.
  void (*merge)(const ChildBatch&, Vec3 half, FactorBatch&);
  // Unconstrained minimiser nearest the mass point; singular values under threshold * largest are
  // dropped.
  void (*solve)(const FactorBatch&, double threshold, SolutionBatch&);
  void (*border)(const BoxedFactor&, BorderPoints&);
  const char* name;
};

// The widest this processor has, unless others were chosen. All of them give the same bits.
const QefKernels& qef_kernels();
// Chooses by name ("base", "avx2", "avx512") for the whole process, before any are used; false
// where this processor has none of that name. To see on one machine what machines of other kinds
// do.
bool choose_qef_kernels(std::string_view name);
const QefKernels& qef_kernels_base();
const QefKernels* qef_kernels_avx2();  // null where the CPU lacks it
const QefKernels* qef_kernels_avx512();

Qef store_lane(const FactorBatch& factor, std::size_t lane);
void load_lane(const Qef& qef, std::size_t lane, FactorBatch& factor);

// Replaces the solution of one lane by the minimiser over the box, where it lies outside: exact over the box's faces, edges and corners, each solved with the same
// threshold; where many are equal but for rounding, the one nearest the mass point.
void constrain_lane(const FactorBatch& factor, std::size_t lane, const LaneBox& box,
                    double threshold, SolutionBatch& solution);

}  // namespace voxweld
