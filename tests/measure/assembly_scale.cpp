// Merge at the size of a volume nobody has at hand: writes octree artifacts as build would leave
// them, with made-up counts, merges them, and prints seconds and peak memory.
// usage: merge_scale FOLDER SHARDS_A_SIDE [PERCENT_OF_BLOCKS_WITH_A_SURFACE]
// 64 shards a side, of 4 bricks of 64 cells, are 16384 samples a side.
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>

#include "pipeline/executor/console.h"
#include "pipeline/executor/resources.h"
#include "pipeline/run/merge_stage.h"
#include "storage/artifact/shard_artifact.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

// Small, fast and the same everywhere (Steele, Lea, Flood, "Fast Splittable Pseudorandom Number
// Generators", 2014).
std::uint64_t mixed(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
  x = (x ^ x >> 27) * 0x94d049bb133111ebu;
  return x ^ x >> 31;
}

void write_shard(const BuildJob& job, Index3 shard, std::uint64_t percent) {
  ShardArtifactWriter out(shard_artifact_path(job, shard), job.key, {});
  ShardSummary summary;
  summary.counts.crossing_edges = 1;
  std::vector<ShardNode> nodes;
  for (const BrickGrid::Cube& cube : job.grid.shard_cubes(shard)) {
    ShardNode node;
    node.key = cube.key;
    node.record.state = NodeState::split;
    const std::uint64_t blocks = std::uint64_t{1} << (3 * (cube.key.level - block_level));
    for (std::uint64_t b = 0; b < blocks; ++b) {
      const std::uint64_t code = cube.key.code() + (b << (3 * block_level));
      const std::uint64_t random = mixed(code);
      if (random % 100 >= percent) continue;
      const auto count = static_cast<std::uint32_t>(20 + random / 100 % 60);
      node.cubes.push_back({code, block_level, count, count});
    }
    nodes.push_back(std::move(node));
  }
  out.finish(summary, nodes);
}

int run(const std::string& folder, std::int64_t side, std::uint64_t percent) {
  const std::int64_t samples = side * 256;
  BuildJob build{{}, BrickGrid({samples, samples, samples}, 6, 4), {}, folder + "/build", {1, 2}};
  const auto shards = build.grid.all_shards();
  const StageMeter writing;
  for (const Index3& shard : shards) write_shard(build, shard, percent);
  fmt::print("{} shards written in {:.1f} s\n", shards.size(), writing.read().wall_s);

  LocalExecutor executor;
  RunContext context;
  context.executor = &executor;
  context.console = Console::standard_error();
  context.progress.enabled = false;
  MergeJob merge{&build, folder + "/merge", {3, 4}, 500000};
  run_merge(context, merge);
  const StageFigures figures = context.reports.back().figures;
  const TopArtifact top(merge.path());
  fmt::print("merged in {:.1f} s, peak {:.1f} MiB: {} tiles\n", figures.wall_s,
             static_cast<double>(figures.peak_resident) / 1048576, top.tiles().size());
  return 0;
}

}  // namespace
}  // namespace voxweld

int main(int argc, char** argv) try {
  if (argc < 3) {
    fmt::print(stderr, "usage: merge_scale FOLDER SHARDS_A_SIDE [PERCENT]\n");
    return 2;
  }
  return voxweld::run(argv[1], std::atoll(argv[2]),
                      argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 10);
} catch (const voxweld::Error& error) {
  fmt::print(stderr, "{}\n", error.what());
  return error.exit_code();
}
