#include "pipeline/build/shard_octrees.h"

#include <algorithm>

#include "pipeline/build/label_octrees.h"
#include "pipeline/build/local_edits.h"
#include "stages/build/cut_brick.h"

namespace voxweld {

namespace {

// Of one surface: its octree is the shard's.
class SurfaceOctrees : public ShardOctrees {
 public:
  SurfaceOctrees(const BuildJob& job, MemoryShare& share)
      : job_(job), edits_(job.parameters), share_(share) {
    scratch_.reserve = [&share](std::uint64_t bytes) { share.reserve(bytes); };
  }

  void free_buffers() override {
    scratch_.free_buffers();
    brick_ = finer_ = {};
    cutter_ = {};
  }
  void begin(Index3 shard, Hash128 input_stamp) override {
    shard_ = shard;
    roots_.clear();
    history_ = ShardHistory{};
    out_.reset();
    summary_ = ShardSummary{};
    out_ = std::make_unique<ShardArtifactWriter>(shard_artifact_path(job_, shard),
                                                 shard_key(job_, shard), input_stamp);
  }
  void build(const HaloBlock& block, Index3 first, std::int64_t count,
             const WorkerContext& worker) override;
  void inside(Index3 brick, Material material) override {
    RootRecord inside;
    inside.state = NodeState::inside;
    if (material == exterior)
      inside.corner_signs = 255;
    else
      inside.corners.fill(material);
    roots_.push_back({{job_.grid.brick_level(), brick}, inside, {}, {}});
  }
  void keep(Index3 brick, const BuiltBrick& built, const ArtifactReader& from) override;
  std::uint64_t cut(Index3 brick, const BuiltBrick& built, const ArtifactReader& from) override;
  void finish(Hash128 input, std::vector<BuiltRun> runs) override {
    summary_.input = input;
    history_.runs = std::move(runs);
    const std::vector<ShardNode> nodes = reduce();
    out_->finish(summary_, nodes, history_);
    out_.reset();
  }

 private:
  struct Root {
    CellKey key;
    RootRecord record;
    std::vector<BlockCount> blocks;  // none where it is inside
    NodeRecord clusters;             // where each sheet collapses by itself
  };
  void note(const CellKey& key, const RootRecord& root, const BrickCounts& counts);
  void note_surface(const CellKey& key, const RootRecord& root,
                    const std::vector<BlockCount>& blocks, const NodeRecord& clusters);
  void put(const CellKey& key, const BrickOctree& brick);
  std::vector<ShardNode> reduce();

  const BuildJob& job_;
  LocalEdits edits_;
  BrickScratch scratch_;
  BrickOctree brick_, finer_;
  BrickCutter cutter_;
  MemoryShare& share_;
  Index3 shard_;
  std::unique_ptr<ShardArtifactWriter> out_;
  std::vector<Root> roots_;
  ShardSummary summary_;
  ShardHistory history_;
};

void SurfaceOctrees::note(const CellKey& key, const RootRecord& root, const BrickCounts& counts) {
  history_.bricks.push_back({morton_encode(key.at), brick_key(job_, key.at), root, counts});
  add_brick(summary_.counts, counts, root.state);
}

// Of a brick that is not all outside.
void SurfaceOctrees::note_surface(const CellKey& key, const RootRecord& root,
                                  const std::vector<BlockCount>& blocks,
                                  const NodeRecord& clusters) {
  const bool surface = root.state != NodeState::inside;
  if (surface) ++summary_.active_bricks;
  roots_.push_back({key, root, surface ? blocks : std::vector<BlockCount>{}, clusters});
}

void SurfaceOctrees::keep(Index3 brick, const BuiltBrick& built, const ArtifactReader& from) {
  const CellKey key{job_.grid.brick_level(), brick};
  note(key, built.root, built.counts);
  if (built.root.state == NodeState::outside) return;
  const bool surface = built.root.state != NodeState::inside;
  note_surface(key, built.root,
               surface ? read_block_counts(from, built.code) : std::vector<BlockCount>{},
               read_node_record(from, built.code));
  if (surface) out_->brick(built.code, from);
}

void SurfaceOctrees::build(const HaloBlock& block, Index3 first, std::int64_t count,
                           const WorkerContext& worker) {
  for (std::int64_t i = 0; i < count; ++i) {
    worker.check_interrupt();
    const CellKey key{job_.grid.brick_level(), first + Index3{i, 0, 0}};
    const ContourParameters& parameters = edits_.around(sign_samples(job_.grid, key.at));
    build_brick(block, place_of_brick(job_.grid, key.at), parameters, scratch_, brick_);
    put(key, brick_);
    share_.yield();
  }
}

void SurfaceOctrees::put(const CellKey& key, const BrickOctree& brick) {
  note(key, brick.root, brick.counts);
  if (brick.root.state == NodeState::outside) return;
  note_surface(key, brick.root, brick.blocks, brick.record);
  if (brick.root.state != NodeState::inside) out_->brick(morton_encode(key.at), brick);
}

std::uint64_t SurfaceOctrees::cut(Index3 brick, const BuiltBrick& built,
                                  const ArtifactReader& from) {
  const CellKey key{job_.grid.brick_level(), brick};
  if (built.root.state != NodeState::split) {
    BrickOctree whole;
    whole.root = built.root;
    whole.counts = built.counts;
    put(key, whole);
    return 0;
  }
  const std::uint64_t bytes = brick_bytes(from, built.code);
  share_.reserve(cut_bytes(bytes));
  read_whole_brick(from, built.code, finer_);
  finer_.root = built.root;
  finer_.counts = built.counts;
  if (!can_be_cut(finer_)) from.damaged("the parts of a brick contradict each other");
  cutter_.cut(finer_, job_.parameters.simplify.tolerance, brick_);
  put(key, brick_);
  share_.yield();
  return bytes;
}

std::vector<ShardNode> SurfaceOctrees::reduce() {
  summary_.bricks = static_cast<std::uint64_t>(job_.grid.shard_bricks(shard_).count());
  std::sort(roots_.begin(), roots_.end(),
            [](const Root& a, const Root& b) { return a.key.code() < b.key.code(); });

  std::vector<ShardNode> nodes;
  auto root = roots_.begin();
  for (const BrickGrid::Cube& cube : job_.grid.shard_cubes(shard_)) {
    CubeReduction reduction(job_.grid, cube.key, job_.parameters);
    for (; root != roots_.end() && cube.key.cells().contains(root->key.cells()); ++root) {
      reduction.add(root->key, root->record, root->blocks);
      if (root->clusters.has_surface()) reduction.add_record(root->key, root->clusters);
    }
    nodes.push_back(reduction.finish());
    add(summary_.counts, reduction.counts());
    summary_.collapsed_above += reduction.collapsed();
  }
  return nodes;
}

}  // namespace

std::unique_ptr<ShardOctrees> make_shard_octrees(const BuildJob& job, MemoryShare& share) {
  if (job.parameters.labels.mode == LabelMode::each)
    return std::make_unique<LabelOctrees>(job, share);
  return std::make_unique<SurfaceOctrees>(job, share);
}

}  // namespace voxweld
