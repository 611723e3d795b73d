#include "pipeline/merge/merge_stage.h"

#include <algorithm>

#include "pipeline/executor/probe.h"
#include "pipeline/merge/label_merge.h"
#include "storage/artifact/shard_artifact.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

// Content hashes of what build has left, in the order of its units.
std::vector<Hash128> shard_hashes(const BuildJob& job) {
  const std::vector<Index3> shards = job.grid.all_shards();
  std::vector<Hash128> hashes(shards.size());
  probe_all(shards.size(),
            [&](std::size_t i) { hashes[i] = open_octrees(job, shards[i]).content_hash(); });
  return hashes;
}

// To the artifact.
class TopWriter : public TopSink {
 public:
  TopWriter(TopArtifactWriter& out, MergeCounts& counts) : out_(out), counts_(counts) {}
  void leaf(const TopLeaf& leaf, bool) override {
    ++counts_.top_leaves;
    out_.leaf(leaf);
  }
  void tile(const PlannedTile& tile) override { out_.tile(tile); }

 private:
  TopArtifactWriter& out_;
  MergeCounts& counts_;
};

constexpr std::size_t cubes_ahead = 128;  // up to 100 KiB each

// What merge reads of one octree artifact: one cube's part of it.
struct CubeRoots {
  Hash128 content;
  ShardSummary summary;
  std::vector<ShardNode> nodes;
};

CubeRoots read_roots(const BuildJob& job, const BrickGrid::Cube& cube) {
  const ShardArtifact artifact(shard_artifact_path(job, cube.shard));
  if (artifact.key() != shard_key(job, cube.shard))
    throw DamagedArtifact(artifact.path(), "is of other parameters");
  CubeRoots roots{artifact.content_hash(), artifact.summary(), {}};
  for (std::uint64_t page = 0; page < artifact.node_pages(); ++page)
    artifact.each_node(page, [&](const MaterialNode& found, std::span<const std::byte>) {
      if (found.node.key == cube.key) roots.nodes.push_back(found.node);
    });
  return roots;
}

// Puts the shards' summaries and hashes in the order of build's units: a shard may have several
// cubes, which come in the order of the octree.
class ShardTotals {
 public:
  explicit ShardTotals(const BrickGrid& grid) {
    for (const Index3& shard : grid.all_shards()) codes_.push_back(morton_encode(shard));
    hashes_.resize(codes_.size());
    seen_.resize(codes_.size());
  }
  void add(Index3 shard, const CubeRoots& roots, MergeCounts& counts) {
    const auto found = std::lower_bound(codes_.begin(), codes_.end(), morton_encode(shard));
    const auto at = static_cast<std::size_t>(found - codes_.begin());
    if (seen_[at]) return;
    seen_[at] = true;
    hashes_[at] = roots.content;
    add_summary(roots.summary, counts);
  }
  const std::vector<Hash128>& hashes() const { return hashes_; }

 private:
  std::vector<std::uint64_t> codes_;  // ascending
  std::vector<Hash128> hashes_;       // beside them
  std::vector<bool> seen_;
};

void merge(const MergeJob& job) {
  const BrickGrid& grid = job.build->grid;
  TopArtifactWriter out(job.path(), job.key);
  MergeCounts counts;
  ShardTotals shards(grid);
  TopWriter sink(out, counts);
  TopReduction reduction(grid, job.build->parameters, job.tile_vertices, sink);
  const std::vector<BrickGrid::Cube> cubes = grid.all_cubes();
  probe_in_order<CubeRoots>(
      cubes.size(), cubes_ahead, [&](std::size_t i) { return read_roots(*job.build, cubes[i]); },
      [&](std::size_t i, CubeRoots&& roots) {
        shards.add(cubes[i].shard, roots, counts);
        for (const ShardNode& node : roots.nodes) reduction.add(node);
      });
  reduction.finish();
  add_reduced(reduction, counts);
  count_top_leaves(*job.build, counts);
  if (collapses_by_sheets(job.build->parameters)) out.clusters(reduction.reduced());
  out.finish(counts, shards.hashes());
}

// Of the nodes of all labels those that are held at once, beside the program itself.
std::uint64_t merge_memory(const RunContext& context) {
  constexpr std::uint64_t least = std::uint64_t{4} << 20, most = std::uint64_t{256} << 20;
  const std::uint64_t total = context.budget().total, taken = program_bytes();
  return std::clamp(total > taken ? (total - taken) / 4 : 0, least, most);
}

class MergeWork final : public StageWork {
 public:
  explicit MergeWork(const MergeJob& job) : job_(job) {}

  Stage stage() const override { return Stage::merge; }
  std::string noun() const override { return "trees"; }
  std::string identity() const override { return job_.folder.filename().string(); }
  std::uint64_t size() const override { return 1; }
  std::vector<Unit> units(std::span<const std::uint64_t> numbers) const override {
    return std::vector<Unit>(numbers.size(), Unit{0, "top tree", 1});
  }
  bool done(std::uint64_t) override {
    return is_current(job_.path(), [&] {
      const TopArtifact artifact(job_.path());
      return artifact.key() == job_.key && artifact.shards() == shard_hashes(*job_.build);
    });
  }
  std::string missing_text(const StageLook&) const override { return {}; }

  StageMemory memory(std::span<const std::uint64_t>) override {
    return {"merge", 0, 0, "the top tree", "raise run.memory"};
  }
  void begin(RunContext& context, std::span<const std::uint64_t>, int) override {
    label_bytes_ = merge_memory(context);
  }
  void run(const Unit&, WorkerContext&) override {
    if (job_.build->parameters.labels.mode == LabelMode::each)
      merge_labels(job_, label_bytes_);
    else
      merge(job_);
  }

 private:
  const MergeJob& job_;
  std::uint64_t label_bytes_ = 0;
};

}  // namespace

namespace {

void add_counts(const BrickCounts& part, MergeCounts& counts) {
  counts.active_cells += part.active_cells;
  counts.crossing_edges += part.crossing_edges;
  counts.vertices += part.vertices;
  counts.worst_residual = std::max(counts.worst_residual, part.worst_residual);
  counts.worst_finest = std::max(counts.worst_finest, part.worst_finest);
  for (std::size_t l = 0; l < counts.leaves.size(); ++l) counts.leaves[l] += part.leaves[l];
}

}  // namespace

void add_summary(const ShardSummary& shard, MergeCounts& counts) {
  counts.bricks += shard.bricks;
  counts.active_bricks += shard.active_bricks;
  counts.collapsed_above += shard.collapsed_above;
  add_counts(shard.counts, counts);
}

void add_reduced(const TopReduction& reduction, MergeCounts& counts) {
  counts.collapsed_above += reduction.collapsed();
  add_counts(reduction.counts(), counts);
}

void count_top_leaves(const BuildJob& job, MergeCounts& counts) {
  if (!collapses_by_sheets(job.parameters)) return;
  for (std::size_t l = static_cast<std::size_t>(job.grid.brick_level()) + 1;
       l < counts.leaves.size(); ++l)
    counts.top_leaves += counts.leaves[l];
}

bool merge_is_there(const MergeJob& job) {
  return std::filesystem::exists(job.path()) && TopArtifact(job.path()).key() == job.key;
}

std::unique_ptr<StageWork> merge_stage(const MergeJob& job) {
  return std::make_unique<MergeWork>(job);
}

}  // namespace voxweld
