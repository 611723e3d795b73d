// Solids made of primitives by union and subtraction, in order. Lengths are in model units: 512ths
// of the volume's side, with the origin at the volume's centre.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/phantom/rotation.h"
#include "storage/types/box.h"

namespace voxweld {

enum class CsgShape : std::uint8_t {
  box,         // half: half sizes
  cylinder_x,  // along x; half.x: half height, half.y: radius
  cylinder_z,  // along z; half.z: half height, half.x: radius
  gable,       // along x, half length half.x; in (y, z) the triangle (-half.y, -half.z),
               // (half.y, -half.z), (0, half.z)
};

struct CsgPrimitive {
  enum class Op : std::uint8_t { unite, subtract };
  Op op;
  CsgShape shape;
  Vec3 centre, half;
};

// q = rows (p - c) / s takes voxels to model units. The first primitive is a union.
struct CsgModel {
  Rows rows;
  std::vector<CsgPrimitive> primitives;
};

// The signed distance of one primitive at q, exact, so that it changes by at most the way walked.
double signed_distance(const CsgPrimitive& primitive, Vec3 q);
// The same at `count` points, given by coordinate; the same bits.
void signed_distances(const CsgPrimitive& primitive, const double* x, const double* y,
                      const double* z, std::size_t count, double* out);

// Turned by M = Rz(0.37) Ry(0.61) Rx(0.23). A plate 300 x 220 x 48 with two walls, a hub of radius
// 62 with a bore of 38, four bolt holes, two cross bores along x, a slot and nine fins 6 thick.
CsgModel part_model();

// In line with the axes, z up. Three steps (boxes of half sizes 200 x 140, 185 x 125, 170 x 110
// from z = -160 up to -140, -120 and -100); 24 columns of radius 13 on the rectangle 150 x 90, from
// z = -110 to 66; a room 100 x 55 with walls 8 thick and a door; a beam 166 x 106 from z = 60 to
// 80; a gabled roof 180 x 120 from z = 72 to 150. Parts that touch overlap by 6 or more, so that
// the field stays well below zero inside.
CsgModel temple_model();

}  // namespace voxweld
