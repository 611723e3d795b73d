// The shortest way to a mesh for a test: samples that a test makes up, and stages/whole.
#pragma once

#include <cstring>
#include <vector>

#include "stages/whole/contour_volume.h"

namespace voxweld::testing {

// Keeps its samples.
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
  // From a function of the sample's index.
  template <class T, class F>
  static MemoryVolume made(Index3 size, SampleType type, F&& value) {
    std::vector<T> values;
    each_index(size, [&](Index3 at) { values.push_back(static_cast<T>(value(at))); });
    return of<T>(size, values, type);
  }
  operator VolumeSamples() const { return {type, size, samples}; }
};

inline Vec3 place_of(const OutputLattice& lattice, const LatticePoint& q) {
  return {lattice.coordinate(0, q[0]), lattice.coordinate(1, q[1]), lattice.coordinate(2, q[2])};
}

// All tiles as one mesh, welded on lattice coordinates alone; triangle order kept.
struct LatticeWeld {
  std::vector<LatticePoint> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};
inline LatticeWeld weld_tiles(const std::vector<TileMesh>& tiles) {
  LatticeWeld welded;
  std::map<LatticePoint, std::uint32_t> index;
  for (const TileMesh& tile : tiles)
    for (const auto& triangle : tile.triangles) {
      std::array<std::uint32_t, 3> corners;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto [at, fresh] = index.emplace(tile.positions[triangle[k]],
                                               static_cast<std::uint32_t>(welded.vertices.size()));
        if (fresh) welded.vertices.push_back(at->first);
        corners[k] = at->second;
      }
      welded.triangles.push_back(corners);
    }
  return welded;
}

}  // namespace voxweld::testing
