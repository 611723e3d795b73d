// A part of a surface's mesh while it is refined: what stitch hands over, and each pass of refine.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "storage/types/lattice_box.h"
#include "storage/types/morton.h"
#include "storage/types/tile_mesh.h"

namespace voxweld {

// A point of the surface before it was refined, with the triangle that stands for it now.
struct SurfaceSample {
  LatticePoint point{};
  std::uint32_t triangle = 0;
  friend bool operator==(const SurfaceSample&, const SurfaceSample&) = default;
};

// Coordinates: steps of the output lattice.
struct RefineMesh {
  // For each vertex. Ids are distinct: in several parts of one mesh the same vertex has the same id.
  std::vector<LatticePoint> positions;
  std::vector<VertexId> ids;
  std::vector<LatticePoint> aims;  // where they would best lie; empty where that is not known
  std::vector<std::array<PackedNormal, max_clusters>> normals;  // empty where normals are off
  // Counter-clockwise seen from outside, the corner with the lowest id first.
  std::vector<std::array<std::uint32_t, 3>> triangles;
  // labels.mode = "shared" only, for each triangle: what it separates. Its normal points out of
  // `inside`.
  std::vector<MaterialPair> sides;
  std::vector<SurfaceSample> samples;  // ascending by triangle
  // Triangles that intersect others, ascending: of each such pair at least one. Where `checked` is
  // false nobody has looked.
  std::vector<std::uint32_t> intersecting;
  bool checked = false;

  bool intersects(std::uint32_t triangle) const {
    return std::binary_search(intersecting.begin(), intersecting.end(), triangle);
  }
  std::array<VertexId, 3> ids_of(std::size_t triangle) const {
    const auto& c = triangles[triangle];
    return {ids[c[0]], ids[c[1]], ids[c[2]]};
  }
  std::array<LatticePoint, 3> shape(std::size_t triangle) const {
    const auto& c = triangles[triangle];
    return {positions[c[0]], positions[c[1]], positions[c[2]]};
  }
  LatticeBox box(std::size_t triangle) const { return LatticeBox::around(shape(triangle)); }
};

}  // namespace voxweld
