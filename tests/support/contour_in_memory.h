// All stages on a volume in memory, without files or threads: what the pipeline's results are
// compared with, and the shortest way to a mesh for a test.
#pragma once

#include <cstring>
#include <map>
#include <vector>

#include "stages/build/build_brick.h"
#include "stages/contouring/parameters.h"
#include "storage/types/brick_octree.h"
#include "storage/types/tile_mesh.h"
#include "storage/types/top_tree.h"
#include "storage/types/volume.h"

namespace voxweld::testing {

struct MemoryVolume {
  SampleType type = SampleType::u8;
  Index3 size;
  std::vector<std::byte> samples;

  template <class T>
  static MemoryVolume of(Index3 size, const std::vector<T>& values, SampleType type) {
    MemoryVolume v{type, size, std::vector<std::byte>(values.size() * sizeof(T))};
    std::memcpy(v.samples.data(), values.data(), v.samples.size());
    return v;
  }
};

struct MemoryContour {
  std::vector<TileMesh> tiles;
  std::vector<PlannedTile> plan;  // of the tiles, in their order
  std::vector<TopLeaf> top;
  BrickCounts counts;  // summed; leaves and vertices of the final octree
  std::uint64_t collapsed_above = 0;
};

struct MemoryOptions {
  int brick_level = 6;
  std::uint64_t tile_vertices = 500000;
  double precision = 0.01;
};

MemoryContour contour_in_memory(const MemoryVolume& volume, const ContourParameters& parameters,
                                const MemoryOptions& options);

// The same in its parts, for tests that build some of the bricks anew or in a way of their own.
struct MemoryBricks {
  Index3 size;  // samples a side of the volume
  ContourParameters parameters;
  MemoryOptions options;
  std::map<std::uint64_t, BrickOctree> octrees;  // by Morton code of the brick's key

  Index3 count() const;  // bricks a side
  BrickPlace place(Index3 brick) const;
};
MemoryContour plan_in_memory(const MemoryBricks& bricks);  // all but the tiles
TileMesh stitch_in_memory(const MemoryBricks& bricks, const MemoryContour& contour,
                          const PlannedTile& tile);

// All tiles as one mesh, welded on lattice coordinates; triangle order kept.
struct LatticeWeld {
  std::vector<std::array<std::int32_t, 3>> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};
LatticeWeld weld_tiles(const std::vector<TileMesh>& tiles);

}  // namespace voxweld::testing
