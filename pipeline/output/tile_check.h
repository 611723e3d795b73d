// One tile on its own: what can be checked inside it, and what has to be compared with others.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "stages/encode/lattice_mesh.h"
#include "storage/manifest/manifest.h"

namespace voxweld {

// Where points of the output lattice lie in the volume.
class PointFrame {
 public:
  explicit PointFrame(const Manifest& manifest);

  Vec3 position(const LatticePoint& q) const;   // output coordinates
  Index3 cell(const LatticePoint& q) const;     // finest octree cell
  bool on_border(const LatticePoint& q) const;  // on or outside the range of the samples

 private:
  OutputLattice lattice_;
  VolumeGeometry geometry_;
  double slack_;
};

// A fan around a kept vertex; numbers index TileSeams::points.
struct SeamFan {
  std::uint32_t vertex = 0, from = 0, to = 0;
  bool closed = false;
};

// How often a label's boundary runs along an edge from `from` to `to` more than the other way,
// within one tile of a mesh between labels; numbers index TileSeams::points.
struct LabelEdge {
  std::uint32_t from = 0, to = 0;
  Material label = exterior;
  int balance = 0;
};

// What other tiles may touch. A vertex is kept when it is not surrounded by exactly one closed fan,
// or when it lies outside the tile's own cube. Two tiles can share a position that neither of them
// keeps only if it lies in both their cubes: never.
struct TileSeams {
  std::vector<LatticePoint> points;
  std::vector<bool> home;  // the point lies in the tile's cube
  // Half-edges that have no single reverse in the tile, and all between two kept vertices.
  std::vector<std::array<std::uint32_t, 2>> half_edges;
  std::vector<SeamFan> fans;  // of all kept vertices
  // Of a mesh between labels, in place of half_edges and fans: a vertex is kept when it is an end
  // of one of these, or when it lies outside the tile's own cube.
  std::vector<LabelEdge> label_edges;  // balance not 0
  std::uint64_t inner_vertices = 0;    // not kept
};

TileSeams find_seams(const LatticeMesh& mesh, const CellKey& tile, const PointFrame& frame);
// The same of a mesh between labels: mesh.pairs has one for each triangle.
TileSeams find_label_seams(const LatticeMesh& mesh, const CellKey& tile, const PointFrame& frame);

// Takes the triangles with two equal corners out, with their pairs; returns how many.
std::uint64_t drop_degenerate(LatticeMesh& mesh);

}  // namespace voxweld
