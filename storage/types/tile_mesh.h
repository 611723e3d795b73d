// One tile's mesh as stitch leaves it and encode takes it: self-contained, in lattice coordinates.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "storage/types/material.h"
#include "storage/types/morton.h"
#include "storage/types/output_lattice.h"

namespace voxweld {

// Unit vector as two 16-bit octahedral coordinates (Cigolle et al., "A Survey of Efficient
// Representations for Independent Unit Vectors", 2014).
struct PackedNormal {
  std::int16_t u = 0, v = 0;
  friend bool operator==(const PackedNormal&, const PackedNormal&) = default;
};
PackedNormal pack_normal(Vec3 unit);
Vec3 unpack_normal(PackedNormal packed);  // unit length

// A vertex keeps at most this many clusters of its Hermite normals.
inline constexpr int max_clusters = 3;

// Which of its vertex's clusters a triangle's corner takes its normal from, and whether it is that
// direction's opposite (where labels meet, a direction serves both sides).
struct CornerNormal {
  std::uint8_t bits = 0;
  static constexpr std::uint8_t values = 8;  // of bits
  static constexpr CornerNormal make(int cluster, bool turned) {
    return {static_cast<std::uint8_t>(cluster | (turned ? 4 : 0))};
  }
  constexpr std::uint8_t cluster() const { return bits & 3; }
  constexpr bool turned() const { return (bits & 4) != 0; }
  constexpr bool valid() const { return bits < values && cluster() < max_clusters; }
  Vec3 of(const std::array<PackedNormal, max_clusters>& normals) const {
    const Vec3 n = unpack_normal(normals[cluster()]);
    return turned() ? n * -1.0 : n;
  }
  friend bool operator==(CornerNormal, CornerNormal) = default;
};

struct TileMesh {
  CellKey tile;
  OutputLattice lattice;

  // For each vertex, all of them used. Order: first use by the triangles (Morton order of the owner
  // cells, axis), so that it depends on nothing but the mesh.
  std::vector<LatticePoint> positions;
  std::vector<VertexId> ids;
  // Where it would best lie, which may be out of its leaf: for refine, else empty.
  std::vector<LatticePoint> aims;
  std::vector<std::array<PackedNormal, max_clusters>> normals;

  // For each triangle: its vertices, counter-clockwise seen from outside, and for each corner its
  // normal (empty when normals are off).
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::array<CornerNormal, 3>> corner_normals;

  // labels.mode = "shared" only: what is on either side of the triangles, ascending, and each
  // triangle's place in that.
  std::vector<MaterialPair> pairs;
  std::vector<std::uint32_t> triangle_pairs;

  // Polygons as the dual walk makes them: quads, and triangles where two cells are one leaf.
  std::uint64_t quads = 0;
  std::uint64_t polygon_triangles = 0;
  // Output triangles whose corners are distinct but collinear.
  std::uint64_t collinear = 0;
};

}  // namespace voxweld
