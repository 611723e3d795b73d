#include "pipeline/stage/shard_memory.h"

#include <algorithm>

#include "stages/build/build_brick.h"
#include "stages/build/label_bricks.h"
#include "stages/contouring/parameters.h"
#include "storage/types/top_tree.h"

namespace voxweld {
namespace {

constexpr std::uint64_t run_bytes = std::uint64_t{16} << 20;
constexpr std::uint64_t label_run_samples = std::uint64_t{1} << 18;  // each may be another label

// Of a shard's bricks what goes on collapsing above them, as held and as written (is_sealed).
std::uint64_t cluster_records_bytes(const BrickGrid& grid) {
  const std::uint64_t clusters = grid.brick_level() == min_brick_level ? 64 : 8;
  const std::uint64_t bricks = std::uint64_t{1} << 3 * (grid.shard_level() - grid.brick_level());
  return bricks * clusters * 2 * (sizeof(ClusterRecord) + 8 * sizeof(FaceCurve));
}

// Of labels' octrees beside their samples and what build_brick takes: each of `samples` samples may
// be of another label.
std::uint64_t label_octrees_bytes(const BrickGrid& grid, std::uint64_t samples) {
  const std::uint64_t side16 = std::uint64_t{1} << (grid.shard_level() - block_level);
  return LabelBricks::memory_bytes(samples) + 2 * material_notes_bytes +
         side16 * side16 * side16 * 4 * sizeof(CubeCount) + (std::uint64_t{1} << 20);
}

}  // namespace

ShardMemory shard_memory(const BrickGrid& grid, SampleType type, const ShardSurface& surface) {
  const std::uint64_t brick = std::uint64_t{1} << grid.brick_level();
  const std::uint64_t halo = 2 + std::uint64_t{2} * (gradient_halo + label_halo);
  const std::uint64_t side = brick + halo;
  const std::uint64_t one = side * side * side;
  ShardMemory memory;
  memory.brick = surface.by_sheets ? build_sheets_bytes(grid.brick_level())
                                   : build_brick_bytes(grid.brick_level());
  if (surface.labels == LabelMode::each) {
    memory.run_samples = label_run_samples;
    const std::uint64_t samples = std::max(one, label_run_samples);
    memory.worker = samples * sample_bytes(type) + label_octrees_bytes(grid, samples) +
                    (surface.by_sheets ? cluster_records_bytes(grid) : 0) +
                    (surface.replaces ? build_replacing_bytes(grid.brick_level()) : 0);
    return memory;
  }
  memory.run_samples = run_bytes / sample_bytes(type);
  const std::uint64_t row = ((std::uint64_t{1} << grid.shard_level()) + halo) * side * side;
  const std::uint64_t side16 = std::uint64_t{1} << (grid.shard_level() - block_level);
  memory.worker =
      std::max(one * sample_bytes(type), std::min(row * sample_bytes(type), run_bytes)) +
      (surface.labels == LabelMode::shared ? build_labels_bytes(grid.brick_level()) : 0) +
      (surface.by_sheets ? cluster_records_bytes(grid) : 0) +
      side16 * side16 * side16 * 2 * sizeof(CubeCount);
  return memory;
}

}  // namespace voxweld
