// A volume cut along its chunks, in the order in which it is best read whole.
#pragma once

#include <array>
#include <cstdint>

#include "storage/types/volume.h"

namespace voxweld {

// The chunks of a volume, and runs of them along x. A run covers whole chunks, cut to the volume;
// together the runs cover it once. Preconditions: no side of the volume or of info.chunk is 0.
class ChunkGrid {
 public:
  explicit ChunkGrid(const VolumeInfo& info);

  // Of the samples of the largest chunk.
  std::uint64_t chunk_bytes() const;
  // Chunks of a run whose samples fit so many bytes; 1 at least, all along x at most.
  std::int64_t run_length(std::uint64_t bytes) const;
  std::uint64_t runs(std::int64_t length) const;
  // Run i of those of that length: x fastest, then y, then z.
  Box3 run(std::uint64_t i, std::int64_t length) const;

 private:
  // Chunk i along an axis is [first + i * chunk, ...), cut to [0, size); -chunk < first <= 0.
  struct Axis {
    std::int64_t size = 1, chunk = 1, first = 0;
    std::int64_t count() const { return (size - first + chunk - 1) / chunk; }
    std::int64_t begin(std::int64_t i) const;
    std::int64_t end(std::int64_t i) const;
  };
  std::int64_t runs_of_row(std::int64_t length) const;

  std::uint64_t sample_bytes_;
  std::array<Axis, 3> axes_;
};

}  // namespace voxweld
