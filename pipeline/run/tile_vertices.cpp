#include "pipeline/run/tile_vertices.h"

#include <spdlog/spdlog.h>

#include "pipeline/config/settings.h"
#include "pipeline/encode/encode_stage.h"
#include "pipeline/executor/memory_budget.h"
#include "stages/refine/coarsen.h"
#include "stages/refine/mesh_part.h"

namespace voxweld {
namespace {

// Of a tile with so many vertices: as many polygons, which is what closed surfaces of quads have.
std::uint64_t tile_bytes(const Config& config, std::int64_t vertices) {
  PlannedTile tile;
  tile.vertices = tile.polygons = static_cast<std::uint64_t>(vertices);
  return encode_bytes(config, tile);
}

// Of a coarser tile made of eight that have so many vertices each and a quarter more: borders are fine, so
// coarse tiles have somewhat more than the tree of levels expects.
std::uint64_t level_bytes(std::int64_t vertices) {
  const std::uint64_t all = 10 * static_cast<std::uint64_t>(vertices);
  const MeshSize size{all, 2 * all, 2 * all, 0};
  return mesh_bytes(size.vertices, size.triangles, size.samples) + coarsen_bytes(size);
}

// Larger tiles are not made quicker, take more memory, and leave most of a small mesh to one thread.
std::int64_t good_tile_vertices(const Config& config) {
  // Viewers take a few tiles of each level, so these have about a megabyte.
  if (has_levels(config)) return 65536;
  // Of connectomics (512^3) Draco took up to 140 MB for a tile of 250000 vertices between labels.
  return config.labels.mode == LabelMode::shared ? 131072 : 250000;
}

constexpr std::int64_t least = 1024;

}  // namespace

std::int64_t fitting_tile_vertices(const Config& config) {
  constexpr std::int64_t least = 1024;
  // Depends on the config alone, so that every process of a run has the same.
  constexpr std::uint64_t program = std::uint64_t{64} << 20, at_once = 2;
  const std::uint64_t memory = config.run.memory;
  const std::uint64_t most = memory > program ? (memory - program) / at_once : 0;
  std::int64_t vertices = good_tile_vertices(config);
  const auto fits = [&](std::int64_t v) {
    return tile_bytes(config, v) <= most &&
           (!has_levels(config) || level_bytes(v) <= most * at_once);
  };
  while (vertices / 2 >= least && !fits(vertices)) vertices /= 2;
  return vertices;
}

// With levels tiles are small for those who look at them. What is stitched and refined at once need not be:
// refine of porous stone (512^3) took a tenth longer in ranges of a tile of 65536 vertices. And so a run
// with levels goes on from what one without them has left.
void fit_tiles(Config& config) {
  if (config.output.tile_vertices != 0) return;
  config.output.tile_vertices = fitting_tile_vertices(config);
  if (!refines(config)) return;
  Config alone = config;
  alone.output.levels = 1;
  config.output.planned_vertices = fitting_tile_vertices(alone);
}

void warn_of_large_tiles(const RunContext& context) {
  const Config& config = context.config;
  const std::uint64_t memory = context.budget().total;
  const std::int64_t limit = config.output.tile_vertices;
  const std::uint64_t largest = program_bytes() + tile_bytes(config, limit);
  if (largest <= memory) return;
  spdlog::warn(
      "run.memory = {} is not enough for a tile of output.tile_vertices = {}, which takes up to {} "
      "to encode: should there be one so large, the run ends after merge; leave the key out and "
      "tiles are made that fit",
      exact_bytes(memory), limit, readable_bytes(static_cast<double>(largest)));
}

}  // namespace voxweld
