// What one process has to do of more labels than anybody has at hand: writes octree artifacts as
// build would leave them, with made-up pieces, merges them, looks whether the batches are there,
// and lists as many made-up meshes as there are labels. Prints seconds and the process's peak
// memory after each.
// usage: label_scale FOLDER LABELS [SHARDS_A_SIDE]
// A label lies in up to four neighbouring shards somewhere in the volume, in a few bricks of each.
// What is in FOLDER already is used again but for what merge makes.
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>

#include "pipeline/build/build_stage.h"
#include "pipeline/encode/listing.h"
#include "pipeline/encode/output_files.h"
#include "pipeline/executor/probe.h"
#include "pipeline/merge/merge_stage.h"
#include "pipeline/stitch/stitch_stage.h"
#include "pipeline/stitch/stitch_work.h"
#include "storage/artifact/asset_record.h"
#include "storage/artifact/material_top.h"
#include "storage/artifact/shard_artifact.h"
#include "storage/artifact/tile_artifact.h"
#include "storage/support/error.h"
#include "tests/measure/scale_support.h"

namespace voxweld {
namespace {

// The labels of each shard, ascending: each has a home, and goes on beyond some of its sides.
std::vector<std::vector<Material>> labels_of_shards(const BrickGrid& grid, std::uint64_t labels) {
  const std::vector<Index3> shards = grid.all_shards();
  std::vector<std::uint64_t> codes;
  codes.reserve(shards.size());
  for (const Index3& shard : shards) codes.push_back(morton_encode(shard));
  std::vector<std::vector<Material>> found(shards.size());
  for (Material label = 1; label <= labels; ++label) {
    const std::uint64_t random = mixed(label);
    const Index3 home = shards[random % shards.size()];
    for (const int d : {0, 1, 2, 4}) {
      if (d != 0 && (random >> (32 + d) & 1) == 0) continue;
      const Index3 at = home + Index3{d & 1, d >> 1 & 1, d >> 2};
      if (!Box3{{}, grid.shards()}.contains(at)) continue;
      const auto place = std::lower_bound(codes.begin(), codes.end(), morton_encode(at));
      found[static_cast<std::size_t>(place - codes.begin())].push_back(label);
    }
  }
  return found;
}

void write_shard(const BuildJob& job, Index3 shard, const std::vector<Material>& labels) {
  ShardArtifactWriter out(shard_artifact_path(job, shard), job.key, {});
  const CellKey cube{job.grid.shard_level(), shard};
  const int up = job.grid.shard_level() - job.grid.brick_level();
  for (const Material label : labels) {
    const std::uint64_t random = mixed(label + cube.code());
    std::uint64_t brick = morton_encode(shard) << (3 * up);
    for (std::uint64_t i = 0; i < 2 + random % 8; ++i) {
      PieceRecord piece;
      brick += 1 + (random >> i & 3);
      piece.key = {label, brick};
      piece.vertices = piece.polygons = 500;
      piece.body = {random, i};
      out.directory(piece);
    }
  }
  for (const Material label : labels) {
    const std::uint64_t random = mixed(label + cube.code());
    MaterialNode node;
    node.material = label;
    node.node.key = cube;
    node.node.record.state = NodeState::split;
    std::uint64_t block = 0;
    for (std::uint64_t i = 0; i < 4 + random % 12; ++i) {
      block += 1 + (random >> i & 127);
      node.node.cubes.push_back(
          {cube.code() + (block << (3 * block_level)), block_level, 200, 200});
    }
    node.content = {random, label};
    out.node(node);
  }
  ShardSummary summary;
  summary.counts.crossing_edges = 1;
  out.finish(summary);
}

void write_batches(const StitchJob& job, const TopArtifact& top, const UnitPlan& plan) {
  StitchWork work(job, top);
  const MaterialTop labels(top);
  const std::vector<BatchRecord> batches = labels.batches();
  probe_all(plan.size(), [&](std::size_t i) {
    TileWriter out(tile_artifact_path(job.folder, plan, i), work.key(i), true);
    for (const SurfaceRecord& s : labels.surfaces(batches[i].first_surface, batches[i].surfaces))
      out.add(s.material, {});
    out.finish();
  });
}

void write_assets(const Listing& listing, const TopArtifact& top) {
  const MaterialTop labels(top);
  const std::vector<BatchRecord> batches = labels.batches();
  probe_all(batches.size(), [&](std::size_t i) {
    AssetRecord record;
    for (const SurfaceRecord& s : labels.surfaces(batches[i].first_surface, batches[i].surfaces)) {
      LabelAsset asset;
      asset.label = s.material;
      asset.octree_vertices = asset.vertices = asset.quads = s.vertices;
      asset.triangles = 2 * s.vertices;
      asset.files = 2;
      record.labels.push_back(asset);
      for (const char* format : {"drc", "glb"})
        record.files.push_back(
            {(label_folder("labels", s.material) / std::to_string(s.material)).string() + "." +
                 format,
             format, "", 4 * s.vertices, to_hex({mixed(s.material), i})});
    }
    write_asset_record(listing.tiles[i].record, record, listing.output);
  });
}

int run(const std::string& folder, std::uint64_t labels, std::int64_t side) {
  const std::int64_t samples = side * 256 - 1;
  Volume volume;
  volume.stamp = [](const Box3&) { return Hash128{}; };
  BuildJob build{
      volume, BrickGrid({samples, samples, samples}, 6, 4), {}, folder + "/build", {1, 2}};
  build.parameters.labels.mode = LabelMode::each;
  build.parameters.labels.rules = std::make_shared<const MaterialRules>();
  LocalExecutor executor;
  RunContext context = quiet_context(executor);

  const auto shards = build.grid.all_shards();
  fmt::print("{} labels in {} shards\n", labels, shards.size());
  timed("build: write what is missing", [&] {
    const StageLook look = build_stage(build)->look({});
    const auto found = labels_of_shards(build.grid, labels);
    for (const std::uint64_t i : look.missing) write_shard(build, shards[i], found[i]);
  });
  MergeJob merge{&build, folder + "/merge", {3, 4}, 500000};
  std::filesystem::remove(merge.path());
  timed("merge", [&] { do_stage(context, *merge_stage(merge)); });

  const TopArtifact top(merge.path());
  const auto plan = unit_plan(top, LabelMode::each);
  fmt::print("{} batches\n", plan->size());
  StitchJob stitch;
  stitch.build = &build;
  stitch.merge = &merge;
  stitch.folder = folder + "/stitch";
  timed("stitch: write the batches", [&] { write_batches(stitch, top, *plan); });
  timed("stitch: look at what is there", [&] {
    if (!stitch_stage(stitch, top, *plan)->look({}).current())
      throw InputError("batches are missing");
  });
  Listing listing;
  listing.output = folder + "/mesh";
  listing.scratch = folder;
  listing.labels = LabelMode::each;
  std::filesystem::create_directories(listing.output);
  for (std::uint64_t i = 0; i < plan->size(); ++i)
    listing.tiles.push_back({{}, plan->path(folder + "/encode", i, ".record")});
  timed("encode: note the names", [&] {
    FileNames names(folder);
    begin_output(listing.output, {{}, {}}, names, [&](FileNames& all) {
      for (std::uint64_t i = 0; i < plan->size(); ++i)
        for (const PlannedMesh& mesh : plan->meshes(i))
          for (const char* ending : {".drc", ".glb"}) all.add(mesh.stem + ending);
    });
  });
  timed("encode: write the batches' records", [&] { write_assets(listing, top); });
  const auto list = [&] { write_lists(listing, folder, samples); };
  timed("encode: list the labels", list);
  timed("encode: list them again", list);
  return 0;
}

}  // namespace
}  // namespace voxweld

int main(int argc, char** argv) try {
  if (argc < 3) {
    fmt::print(stderr, "usage: label_scale FOLDER LABELS [SHARDS_A_SIDE]\n");
    return 2;
  }
  return voxweld::run(argv[1], std::strtoull(argv[2], nullptr, 10),
                      argc > 3 ? std::atoll(argv[3]) : 8);
} catch (const voxweld::Error& error) {
  fmt::print(stderr, "{}\n", error.what());
  return error.exit_code();
}
