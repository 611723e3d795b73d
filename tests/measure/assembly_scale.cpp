// What one process has to do of a volume nobody has at hand: writes octree artifacts as build would
// leave them, with made-up counts, looks whether they are current, merges them, and lists as many
// made-up assets as there are tiles. Prints seconds and the process's peak memory after each.
// usage: assembly_scale FOLDER SHARDS_A_SIDE [PERCENT_OF_BLOCKS_WITH_A_SURFACE]
// 64 shards a side, of 4 bricks of 64 cells, are 16384 samples a side. What is in FOLDER already is
// used again. Run with slow_files.so preloaded the files are as far away as on a network.
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>

#include "pipeline/build/build_stage.h"
#include "pipeline/encode/listing.h"
#include "pipeline/executor/probe.h"
#include "pipeline/merge/merge_stage.h"
#include "pipeline/stage/file_layout.h"
#include "storage/artifact/asset_record.h"
#include "storage/artifact/shard_artifact.h"
#include "storage/artifact/top_artifact.h"
#include "storage/support/error.h"
#include "tests/measure/scale_support.h"

namespace voxweld {
namespace {

void write_shard(const BuildJob& job, Index3 shard, std::uint64_t percent) {
  ShardArtifactWriter out(shard_artifact_path(job, shard), job.key, {});
  ShardSummary summary;
  summary.counts.crossing_edges = 1;
  for (const BrickGrid::Cube& cube : job.grid.shard_cubes(shard)) {
    MaterialNode node;
    node.material = sole_material;
    node.node.key = cube.key;
    node.node.record.state = NodeState::split;
    const std::uint64_t blocks = std::uint64_t{1} << (3 * (cube.key.level - block_level));
    for (std::uint64_t b = 0; b < blocks; ++b) {
      const std::uint64_t code = cube.key.code() + (b << (3 * block_level));
      const std::uint64_t random = mixed(code);
      if (random % 100 >= percent) continue;
      const auto count = static_cast<std::uint32_t>(20 + random / 100 % 60);
      node.node.cubes.push_back({code, block_level, count, count});
    }
    out.node(node);
  }
  out.finish(summary);
}

void write_assets(const Listing& listing) {
  probe_all(listing.tiles.size(), [&](std::size_t i) {
    AssetRecord record;
    record.vertices = 500000 - mixed(i) % 300000;
    record.quads = record.vertices;
    record.triangles = 2 * record.quads;
    for (const char* format : {"drc", "glb"})
      record.files.push_back({fmt::format("tiles/{:03}/{}.{}", i / 200, i, format), format, "",
                              4 * record.vertices, to_hex({mixed(i), mixed(i + 1)})});
    write_asset_record(listing.tiles[i].record, record, listing.output);
  });
}

int run(const std::string& folder, std::int64_t side, std::uint64_t percent) {
  const std::int64_t samples = side * 256;
  Volume volume;
  volume.stamp = [](const Box3&) { return Hash128{}; };
  BuildJob build{
      volume, BrickGrid({samples, samples, samples}, 6, 4), {}, folder + "/build", {1, 2}};
  LocalExecutor executor;
  RunContext context = quiet_context(executor);

  const auto shards = build.grid.all_shards();
  fmt::print("{} shards\n", shards.size());
  timed("build: write what is missing", [&] {
    for (const std::uint64_t i : build_stage(build)->look({}).missing)
      write_shard(build, shards[i], percent);
  });
  timed("build: look at what is there", [&] {
    if (!build_stage(build)->look({}).current()) throw InputError("shards are missing");
  });
  MergeJob merge{&build, folder + "/merge", {3, 4}, 500000};
  std::filesystem::remove(merge.path());
  timed("merge", [&] { do_stage(context, *merge_stage(merge)); });

  Listing listing;
  listing.output = folder + "/mesh";
  const TopArtifact top(merge.path());
  const MaterialTop tables(top);
  for (const PlannedTile& tile : tables.tiles(0, tables.tile_count()))
    listing.tiles.push_back({tile.key(), fanned_out(folder + "/encode", tile.key().at,
                                                    fmt::format("{}-{}", tile.level, tile.code))});
  fmt::print("{} tiles\n", listing.tiles.size());
  timed("encode: write the tiles' records", [&] { write_assets(listing); });
  const auto list = [&] { write_lists(listing, folder, samples); };
  timed("encode: list the tiles", list);
  timed("encode: list them again", list);
  return 0;
}

}  // namespace
}  // namespace voxweld

int main(int argc, char** argv) try {
  if (argc < 3) {
    fmt::print(stderr, "usage: assembly_scale FOLDER SHARDS_A_SIDE [PERCENT]\n");
    return 2;
  }
  return voxweld::run(argv[1], std::atoll(argv[2]),
                      argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 10);
} catch (const voxweld::Error& error) {
  fmt::print(stderr, "{}\n", error.what());
  return error.exit_code();
}
