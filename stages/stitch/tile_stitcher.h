// Stitch: the polygons of one tile, brick by brick, with the upper neighbours' ghost layers for the
// corners that lie beyond; a vertex is computed once and referred to by id, so there is nothing to
// patch.
//
// Based on: Ju, Losasso, Schaefer, Warren, "Dual Contouring of Hermite Data", 2002, section 3.2.
// See stages/build/brick_polygons.h for what a brick hands over.
#pragma once

#include <array>
#include <map>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "stages/stitch/snap.h"
#include "storage/types/tile_mesh.h"
#include "storage/types/top_tree.h"

namespace voxweld {

struct StitchParameters {
  LatticeFrame frame;
  Vec3 first{};  // output coordinates of sample (0, 0, 0), multiples of the lattice's step
  bool normals = true;
  bool aims = false;  // TileMesh::aims are wanted
  // Which normals corners take, and how many triangles are collinear: not for a mesh that is refined.
  bool triangle_notes = true;
};

// One brick with what its polygons refer to. The spans are the caller's and need to live for the
// call only.
struct StitchBrick {
  CellKey key;
  std::span<const LeafVertex> vertices;
  std::span<const std::uint8_t> roots;        // beside vertices, where each sheet is one by itself
  std::span<const PolygonRefs> polygons;      // only those whose owner cells lie in the tile
  std::span<const std::uint8_t> emit_levels;  // beside polygons, or empty
  // labels.mode = "shared": as BrickOctree has them, polygon_pairs beside polygons; else empty.
  std::span<const MaterialPair> pairs;
  std::span<const std::uint32_t> polygon_pairs;
  const GhostLayer* own_layer = nullptr;
  std::array<const GhostLayer*, 8> upper{};  // by direction; null where no brick has a surface
};

class TileStitcher {
 public:
  // top: the leaves above the bricks that the tile's bricks and their upper neighbours lie in,
  // ascending code. above: the same where each sheet collapses by itself. Copied nowhere: both live
  // as long as the stitcher.
  TileStitcher(CellKey tile, const StitchParameters& parameters, std::span<const TopLeaf> top,
               const AboveBricks* above = nullptr);

  // Bricks in Morton order. Throws std::logic_error (a bug or inconsistent artifacts) when a corner
  // cannot be resolved, naming the brick.
  void add(const StitchBrick& brick);

  TileMesh finish();

 private:
  struct Corner {
    std::uint32_t index;  // in the tile's mesh
    int level;            // of its leaf
  };
  Corner local_corner(const StitchBrick& brick, std::uint32_t vertex);
  Corner foreign_corner(const StitchBrick& brick, CornerRef ref);
  Corner shared_vertex(CellKey brick, std::span<const LeafVertex> group);
  const ClusterLeaf* sheet_above(const BrickAbove* around, std::uint8_t root) const;
  template <class VertexAt>
  std::uint32_t sheet_vertex(CellKey brick, std::span<const std::uint8_t> roots, std::size_t vertex,
                             const VertexAt& vertex_at, bool is_shared);
  const TopLeaf* leaf_above(CellKey brick) const;
  std::uint32_t append(VertexId id, const LatticePoint& point, const LeafVertex& vertex);
  void add_polygon(std::array<std::uint32_t, 4> corners);
  void note_pair(const MaterialPair& pair);
  void sort_pairs();
  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c);

  StitchParameters parameters_;
  std::span<const TopLeaf> top_;
  const AboveBricks* above_;
  TileMesh mesh_;
  std::vector<NormalSense> senses_;  // of the mesh's vertices
  // Vertices that several bricks refer to, those of the ghost layers and of the leaves above: found
  // by id.
  std::unordered_map<std::uint64_t, std::uint32_t> shared_;
  std::map<MaterialPair, std::uint32_t> pairs_;  // place in mesh_.pairs, as first met
  std::vector<std::uint32_t> local_;        // of the current brick: index in the mesh, or unset
  std::vector<std::uint8_t> in_own_layer_;  // of the current brick
  const TopLeaf* brick_above_ = nullptr;
  std::vector<LeafVertex> group_;
  std::vector<std::array<float, 3>> offsets_;
};

// Bytes a stitcher holds for a tile of so many vertices and polygons, brick data not counted.
std::uint64_t stitch_bytes(std::uint64_t vertices, std::uint64_t polygons);

}  // namespace voxweld
