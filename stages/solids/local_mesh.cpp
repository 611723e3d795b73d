#include "stages/solids/local_mesh.h"

#include <utility>

namespace voxweld {

LocalMesh::LocalMesh(MeshBin&& bin, const LocalMeshFrame& frame)
    : frame_(frame),
      first_(std::move(bin.first)),
      mesh_(std::move(bin.corners), frame.samples, frame.spacing, frame.source) {}

std::uint64_t LocalMesh::memory_bytes(std::uint64_t triangles, const Box3& samples) {
  // Corners, their numbers, the rows of one axis, and the lists of all three: 4 places in them on
  // average, and as many as two bins.
  constexpr std::uint64_t of_triangle =
      3 * sizeof(Index3) + 12 + sizeof(MeshRowIndex::Rows) + std::uint64_t{3} * (4 + 2) * 4;
  return triangles * of_triangle + 2 * row_words(samples) * 8 + 4096;
}

void LocalMesh::each_flip(const Box3& samples, const std::function<void(const Flip&)>& flip) const {
  if (samples.empty()) return;
  for (std::int64_t z = samples.lo.z; z < samples.hi.z; ++z)
    for (std::int64_t y = samples.lo.y; y < samples.hi.y; ++y) {
      const std::uint64_t row = row_number(frame_.samples, y, z);
      if ((first_[row / 64] >> (row % 64) & 1) != 0) flip({samples.lo.x, y, z});
    }
  // Those at the frame's first samples, and before, are in first_ already.
  Box3 whole_rows = samples;
  whole_rows.lo.x = frame_.samples.lo.x;
  mesh_.each_flip(whole_rows, [&](const Flip& own) {
    if (own.x > whole_rows.lo.x) flip({std::max(own.x, samples.lo.x), own.y, own.z});
  });
}

std::vector<std::uint64_t> LocalMesh::sides_at(std::int64_t x) const {
  std::vector<std::uint64_t> sides(row_words(frame_.samples));
  Box3 layer = frame_.samples;
  layer.lo.x = x;
  layer.hi.x = x + 1;
  each_flip(layer, [&](const Flip& flip) {
    const std::uint64_t row = row_number(frame_.samples, flip.y, flip.z);
    sides[row / 64] ^= std::uint64_t{1} << (row % 64);
  });
  return sides;
}

}  // namespace voxweld
