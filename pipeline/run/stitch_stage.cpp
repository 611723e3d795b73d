#include "pipeline/run/stitch_stage.h"

#include <fmt/format.h>

#include <algorithm>

#include "pipeline/executor/probe.h"
#include "pipeline/run/tile_inputs.h"
#include "storage/artifact/tile_artifact.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

// A worker's brick and its neighbours' skins, reused.
struct Scratch {
  BrickOctree brick;
  std::array<Skin, 8> upper;
};

struct TileWork {
  PlannedTile tile;
  std::vector<CellKey> bricks;
  std::vector<TopLeaf> above;
  Hash128 key;
};

TileWork prepare(const StitchJob& job, const PlannedTile& tile, const TopArtifact& top,
                 ShardFiles& files) {
  TileWork work;
  work.tile = tile;
  work.bricks = tile_bricks(*job.build, tile.key(), files);
  work.above = leaves_above(*job.build, work.bricks, top);
  work.key = tile_key(job, tile, work.bricks, work.above, files);
  return work;
}

// What it would be made from is looked up only where there is something to compare it with.
bool is_current(const StitchJob& job, const PlannedTile& tile, const TopArtifact& top,
                ShardFiles& files) {
  const auto path = tile_artifact_path(job, tile.key());
  if (!std::filesystem::exists(path)) return false;
  try {
    return TileArtifact(path).key() == prepare(job, tile, top, files).key;
  } catch (const DamagedArtifact& damage) {
    if (damage.path() != path.string()) throw;
    return false;
  }
}

// The most bytes that stitching one of these tiles takes.
std::uint64_t largest_tile_bytes(const StitchJob& job, const std::vector<PlannedTile>& tiles,
                                 const std::vector<std::uint64_t>& numbers, ShardFiles& files) {
  std::vector<std::uint64_t> need(numbers.size());
  probe_all(numbers.size(), [&](std::size_t i) {
    const PlannedTile& tile = tiles[numbers[i]];
    need[i] = stitch_bytes(tile.vertices + tile.vertices / 4, tile.polygons) +
              largest_brick_bytes(tile_bricks(*job.build, tile.key(), files), files);
  });
  return need.empty() ? 0 : *std::max_element(need.begin(), need.end());
}

// The polygons of the brick whose owner cells lie in the tile: all, or those of some 16^3 blocks.
void cut_to_tile(const PlannedTile& tile, const BrickOctree& octree, StitchBrick& brick) {
  if (static_cast<int>(tile.level) >= brick.key.level) return;
  const std::uint64_t first = (tile.code - brick.key.code()) >> (3 * block_level);
  const std::uint64_t count = std::uint64_t{1}
                              << (3 * (static_cast<int>(tile.level) - block_level));
  const std::size_t begin = first == 0 ? 0 : octree.blocks[first - 1].polygon_end;
  const std::size_t end = octree.blocks[first + count - 1].polygon_end;
  brick.polygons = brick.polygons.subspan(begin, end - begin);
  if (!brick.polygon_pairs.empty())
    brick.polygon_pairs = brick.polygon_pairs.subspan(begin, end - begin);
  if (!brick.emit_levels.empty()) brick.emit_levels = brick.emit_levels.subspan(begin, end - begin);
}

void stitch(const StitchJob& job, const TileWork& work, ShardFiles& files, Scratch& scratch,
            WorkerContext& worker) {
  TileStitcher stitcher(work.tile.key(), job.parameters, work.above);
  for (const CellKey& key : work.bricks) {
    worker.check_interrupt();
    const auto file = files.of_brick(key.at);
    file->read_brick(morton_encode(key.at), scratch.brick);
    StitchBrick brick{key,
                      scratch.brick.vertices,
                      scratch.brick.polygons,
                      scratch.brick.emit_levels,
                      scratch.brick.pairs,
                      scratch.brick.polygon_pairs,
                      &scratch.brick.skin,
                      {}};
    for (std::size_t d = 1; d < 8; ++d) {
      const Index3 at = upper_neighbour(key.at, static_cast<int>(d));
      const auto neighbour = files.of_brick(at);
      if (neighbour == nullptr || !neighbour->has_brick(morton_encode(at))) continue;
      neighbour->read_skin(morton_encode(at), scratch.upper[d]);
      brick.upper[d] = &scratch.upper[d];
    }
    cut_to_tile(work.tile, scratch.brick, brick);
    stitcher.add(brick);
  }
  write_tile(tile_artifact_path(job, work.tile.key()), work.key, stitcher.finish());
}

}  // namespace

std::filesystem::path tile_artifact_path(const StitchJob& job, CellKey tile) {
  return fanned_out(job.folder, tile.at,
                    fmt::format("{}-{}-{}-{}.tile", tile.level, tile.at.x, tile.at.y, tile.at.z));
}

std::vector<std::uint64_t> missing_tiles(const RunContext& context, const StitchJob& job,
                                         const TopArtifact& top) {
  ShardFiles files(*job.build, top);
  const std::vector<PlannedTile> tiles = top.tiles();
  const auto missing = probe_which(tiles.size(), [&](std::size_t i) {
    return context.selection.contains(i) && !is_current(job, tiles[i], top, files);
  });
  return {missing.begin(), missing.end()};
}

void run_stitch(RunContext& context, const StitchJob& job) {
  const TopArtifact top(job.merge->path());
  const std::vector<PlannedTile> tiles = top.tiles();
  context.selection.check("stitch", "tiles", tiles.size());
  const std::vector<std::uint64_t> missing = missing_tiles(context, job, top);
  ShardFiles files(*job.build, top);
  std::vector<Unit> units;
  for (const std::uint64_t number : missing) {
    const PlannedTile& tile = tiles[number];
    const CellKey key = tile.key();
    units.push_back({number,
                     fmt::format("tile {}-{}-{}-{}", key.level, key.at.x, key.at.y, key.at.z),
                     static_cast<double>(tile.vertices + tile.polygons)});
  }
  // Elsewhere each process looks at its own tiles.
  const std::uint64_t need =
      context.executor->in_process() ? largest_tile_bytes(job, tiles, missing, files) : 0;
  StageRun stage;
  stage.stage = "stitch";
  stage.noun = "tiles";
  stage.reused = context.selection.count(tiles.size()) - missing.size();
  stage.memory = {
      "stitch", 0, need,
      fmt::format("one tile (output.tile_vertices = {})", context.config.output.tile_vertices),
      "raise run.memory or lower output.tile_vertices"};
  const int threads = stage_threads(context, stage.memory);
  stage.identity = job.folder.filename().string();
  stage.done = [&](const Unit& unit) { return is_current(job, tiles[unit.key], top, files); };
  std::vector<Scratch> scratch(static_cast<std::size_t>(threads));
  run_stage(context, stage, units, threads, [&](const Unit& unit, WorkerContext& worker) {
    const TileWork work = prepare(job, tiles[unit.key], top, files);
    stitch(job, work, files, scratch[static_cast<std::size_t>(worker.slot())], worker);
  });
}

}  // namespace voxweld
