// The tile plan: the largest aligned cubes with at most a given number of vertices, found in one
// pass over cube counts in Morton order, holding eight siblings a level.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "storage/types/top_tree.h"

namespace voxweld {

class TilePlanner {
 public:
  // domain_level: the octree's root. emit: takes the tiles, in Morton order. A cube that arrives
  // larger than the limit is a tile by itself: it cannot be cut.
  TilePlanner(int domain_level, std::uint64_t tile_vertices,
              std::function<void(const PlannedTile&)> emit);

  void push(const CubeCount& cube);  // in Morton order, not overlapping
  void finish();

 private:
  struct OpenNode {
    CellKey key;
    bool too_large = false;  // it holds more than one tile may: parts are passed on as they come
    std::uint64_t vertices = 0, polygons = 0;
    std::vector<PlannedTile> parts;  // children so far, none too large; at most eight
  };
  void add(const PlannedTile& part);
  void close_last();
  void mark_too_large();

  CellKey root_;
  std::uint64_t limit_;
  std::function<void(const PlannedTile&)> emit_;
  std::vector<OpenNode> open_;
};

}  // namespace voxweld
