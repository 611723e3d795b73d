// All stages on a volume in memory, without files or threads: what the pipeline's results are
// compared with, and the shortest way to a mesh for a test.
#pragma once

#include <cstring>
#include <vector>

#include "stages/geometry/parameters.h"
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

// All tiles as one mesh, welded on lattice coordinates; triangle order kept.
struct LatticeWeld {
  std::vector<std::array<std::int32_t, 3>> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};
LatticeWeld weld_tiles(const std::vector<TileMesh>& tiles);

}  // namespace voxweld::testing
