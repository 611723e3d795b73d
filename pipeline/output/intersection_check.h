// Triangles of an output that intersect, exactly, of any number of tiles.
//
// Each tile is looked at twice. First by itself; of its triangles those stay that leave its cube.
// Tiles' cubes have no point in common, so of two triangles of different tiles that intersect one
// leaves its cube at least: the second time each tile is compared with those of the others.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "pipeline/output/tile_check.h"
#include "stages/exact/box_tree.h"
#include "stages/exact/triangle_pair.h"
#include "storage/types/morton.h"

namespace voxweld {

// How many pairs of triangles have more in common than shared corners and edges, and where the
// first of them are.
struct IntersectionCount {
  static constexpr std::size_t most_places = 20;

  std::uint64_t pairs = 0;
  std::uint64_t degenerate = 0;  // triangles without an area; in no pair
  std::vector<Vec3> first;       // a corner of one of them, output coordinates

  void note(Vec3 place) {
    if (++pairs <= most_places) first.push_back(place);
  }
  IntersectionCount& operator+=(const IntersectionCount& other);
};

// What a tile has by itself.
struct TileIntersections {
  IntersectionCount count;
  LatticeBox box;  // of its triangles
  std::vector<LatticeTriangle> leaving;
};
TileIntersections intersections_within(const LatticeMesh& mesh, const CellKey& tile,
                                       const PointFrame& frame);

// All tiles of a surface.
class IntersectionCheck {
 public:
  // In the order of the tiles.
  void add(TileIntersections&& tile);

  // Once all are there.
  void close();
  // Whether another tile's triangles may intersect those of that tile, by its place in the order.
  bool needs(std::size_t tile) const;
  // With triangles of other tiles. Each pair is found in one of both tiles only.
  IntersectionCount between(std::size_t tile, const LatticeMesh& mesh, const CellKey& cube,
                            const PointFrame& frame) const;

  // Of the tiles by themselves.
  const IntersectionCount& within() const { return within_; }

 private:
  IntersectionCount within_;
  std::vector<LatticeBox> boxes_;            // of the tiles
  std::vector<LatticeTriangle> leaving_;     // tile by tile
  std::vector<std::uint32_t> leaving_from_;  // the tile of each
  std::unique_ptr<BoxTree> tree_;            // of the leaving ones
};

}  // namespace voxweld
