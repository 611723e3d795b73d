// Meshes whose vertices are points of the output lattice: what decoding and welding gives back.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "stages/encode/draco_codec.h"
#include "storage/types/index_table.h"
#include "storage/types/output_lattice.h"
#include "storage/types/tile_mesh.h"

namespace voxweld {

using Triangle = std::array<std::uint32_t, 3>;

constexpr std::uint64_t hash_point(const LatticePoint& q) {
  const auto u = [](std::int32_t v) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(v));
  };
  return mix_bits(mix_bits(u(q[0]) | u(q[1]) << 32) + u(q[2]));
}

// Distinct points, numbered by first use.
class PointIndex {
 public:
  PointIndex() = default;
  PointIndex(const PointIndex&) = delete;
  PointIndex& operator=(const PointIndex&) = delete;

  // The number of the point, new or not. InputError past 2^32 - 1 points.
  std::uint32_t add(const LatticePoint& q);
  std::uint32_t find(const LatticePoint& q) const;  // or none
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  void reserve(std::size_t count);
  const std::vector<LatticePoint>& points() const { return points_; }
  std::vector<LatticePoint> take() {
    table_.clear();
    return std::move(points_);
  }

 private:
  struct Hash {
    const std::vector<LatticePoint>* points;
    std::uint64_t operator()(std::uint32_t i) const { return hash_point((*points)[i]); }
  };
  std::vector<LatticePoint> points_;
  IndexTable<Hash> table_{Hash{&points_}};
};

struct LatticeMesh {
  std::vector<LatticePoint> positions;  // distinct, numbered by first use by the triangles
  std::vector<Triangle> triangles;
  // Of meshes between labels: on either side of each triangle; else empty.
  std::vector<MaterialPair> pairs = {};
};

// FormatError, starting with `where`, when a coordinate is no lattice point or out of its range.
LatticePoint lattice_point(const std::array<float, 3>& position, const OutputLattice& lattice,
                           const std::string& where);

// Joins the points of equal position: exactly, by lattice coordinates. Unused points are dropped.
// FormatError, starting with `where`, when a coordinate is no lattice point or out of its range.
LatticeMesh weld(const DecodedMesh& mesh, const OutputLattice& lattice,
                 const std::string& where = "mesh");

// A sum over triangles (and the labels they separate) that does not depend on their order nor on
// which corner comes first, and tells different sets of triangles apart but for one chance in
// 2^128: comparing two meshes takes no memory, and the sum of tiles is the sum of their digests.
struct TriangleDigest {
  std::uint64_t count = 0, a = 0, b = 0;
  TriangleDigest& operator+=(const TriangleDigest& other) {
    count += other.count;
    a += other.a;
    b += other.b;
    return *this;
  }
  friend bool operator==(const TriangleDigest&, const TriangleDigest&) = default;
};
TriangleDigest digest(const LatticeMesh& mesh);
// Of one triangle. pair: null where it separates no labels.
TriangleDigest digest(const std::array<LatticePoint, 3>& corners, const MaterialPair* pair);

}  // namespace voxweld
