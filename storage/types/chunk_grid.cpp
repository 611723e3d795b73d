#include "storage/types/chunk_grid.h"

#include <algorithm>

namespace voxweld {

std::int64_t ChunkGrid::Axis::begin(std::int64_t i) const {
  return std::max<std::int64_t>(0, first + i * chunk);
}

std::int64_t ChunkGrid::Axis::end(std::int64_t i) const {
  return std::min(size, first + (i + 1) * chunk);
}

ChunkGrid::ChunkGrid(const VolumeInfo& info) : sample_bytes_(sample_bytes(info.type)) {
  for (int a = 0; a < 3; ++a) {
    const std::int64_t chunk = info.chunk[a];
    const std::int64_t first = ((info.chunk_first[a] % chunk) + chunk) % chunk;
    axes_[static_cast<std::size_t>(a)] = {info.geometry.size[a], chunk,
                                          first == 0 ? 0 : first - chunk};
  }
}

std::uint64_t ChunkGrid::chunk_bytes() const {
  std::uint64_t bytes = sample_bytes_;
  for (const Axis& axis : axes_)
    bytes *= static_cast<std::uint64_t>(std::min(axis.size, axis.chunk));
  return bytes;
}

std::int64_t ChunkGrid::run_length(std::uint64_t bytes) const {
  const auto row = static_cast<std::uint64_t>(axes_[0].count());
  return static_cast<std::int64_t>(std::clamp<std::uint64_t>(bytes / chunk_bytes(), 1, row));
}

std::int64_t ChunkGrid::runs_of_row(std::int64_t length) const {
  return (axes_[0].count() + length - 1) / length;
}

std::uint64_t ChunkGrid::runs(std::int64_t length) const {
  return static_cast<std::uint64_t>(runs_of_row(length)) *
         static_cast<std::uint64_t>(axes_[1].count()) *
         static_cast<std::uint64_t>(axes_[2].count());
}

Box3 ChunkGrid::run(std::uint64_t i, std::int64_t length) const {
  const std::int64_t row = runs_of_row(length);
  const auto n = static_cast<std::int64_t>(i);
  const std::int64_t x = n % row * length, y = n / row % axes_[1].count(),
                     z = n / row / axes_[1].count();
  const std::int64_t last = std::min(x + length, axes_[0].count()) - 1;
  return {{axes_[0].begin(x), axes_[1].begin(y), axes_[2].begin(z)},
          {axes_[0].end(last), axes_[1].end(y), axes_[2].end(z)}};
}

}  // namespace voxweld
