#include "pipeline/build/shard_octrees.h"

#include <algorithm>

#include "pipeline/build/label_octrees.h"
#include "pipeline/build/local_edits.h"

namespace voxweld {

void NodeCollector::leaf(CellKey key, const RootRecord& record) {
  BrickCounts& counts = summary->counts;
  ++counts.vertices;
  ++counts.leaves[static_cast<std::size_t>(key.level)];
  counts.worst_residual = std::max(counts.worst_residual, static_cast<double>(record.residual));
  if (key.level > brick_level)
    node->leaves.push_back(
        {key.code(), static_cast<std::uint32_t>(key.level), record.vertex, record.residual, 0});
}

void add_counts(const BrickCounts& from, BrickCounts& to, bool own_leaves) {
  to.active_cells += from.active_cells;
  to.crossing_edges += from.crossing_edges;
  if (!own_leaves) return;
  to.vertices += from.vertices;
  for (std::size_t l = 0; l < from.leaves.size(); ++l) to.leaves[l] += from.leaves[l];
  to.worst_residual = std::max(to.worst_residual, from.worst_residual);
  to.worst_finest = std::max(to.worst_finest, from.worst_finest);
}

namespace {

// Of one surface: its octree is the shard's.
class SurfaceOctrees : public ShardOctrees {
 public:
  explicit SurfaceOctrees(const BuildJob& job) : job_(job), edits_(job.parameters) {}

  void share_memory(MemoryShare* share) override {
    share_ = share;
    scratch_.reserve = nullptr;
    if (share != nullptr) scratch_.reserve = [share](std::uint64_t bytes) { share->reserve(bytes); };
  }
  void free_buffers() override {
    scratch_.free_buffers();
    brick_ = {};
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
    roots_.push_back({{{job_.grid.brick_level(), brick}, inside, 0}, {}});
  }
  void keep(Index3 brick, const BuiltBrick& built, const ArtifactReader& from) override;
  void finish(Hash128 input, std::vector<BuiltRun> runs) override {
    summary_.input = input;
    history_.runs = std::move(runs);
    const std::vector<ShardNode> nodes = reduce();
    out_->finish(summary_, nodes, history_);
    out_.reset();
  }

 private:
  struct Root {
    NodeSummary node;
    std::vector<BlockCount> blocks;
  };
  void note(const CellKey& key, const RootRecord& root, const BrickCounts& counts);
  void note_surface(const CellKey& key, const RootRecord& root,
                    const std::vector<BlockCount>& blocks);
  std::vector<ShardNode> reduce();

  const BuildJob& job_;
  LocalEdits edits_;
  BrickScratch scratch_;
  BrickOctree brick_;
  MemoryShare* share_ = nullptr;
  Index3 shard_;
  std::unique_ptr<ShardArtifactWriter> out_;
  std::vector<Root> roots_;
  ShardSummary summary_;
  ShardHistory history_;
};

void SurfaceOctrees::note(const CellKey& key, const RootRecord& root, const BrickCounts& counts) {
  history_.bricks.push_back({morton_encode(key.at), brick_key(job_, key.at), root, counts});
  add_counts(counts, summary_.counts, root.state != NodeState::leaf);
}

// Of a brick that is not all outside.
void SurfaceOctrees::note_surface(const CellKey& key, const RootRecord& root,
                                  const std::vector<BlockCount>& blocks) {
  roots_.push_back({{key, root, 0}, {}});
  if (root.state == NodeState::inside) return;
  ++summary_.active_bricks;
  if (root.state == NodeState::leaf)
    roots_.back().node.polygons = blocks.back().polygon_end;
  else
    roots_.back().blocks = blocks;
}

void SurfaceOctrees::keep(Index3 brick, const BuiltBrick& built, const ArtifactReader& from) {
  const CellKey key{job_.grid.brick_level(), brick};
  note(key, built.root, built.counts);
  if (built.root.state == NodeState::outside) return;
  const bool surface = built.root.state != NodeState::inside;
  note_surface(key, built.root,
               surface ? read_block_counts(from, built.code) : std::vector<BlockCount>{});
  if (surface) out_->brick(built.code, from);
}

void SurfaceOctrees::build(const HaloBlock& block, Index3 first, std::int64_t count,
                           const WorkerContext& worker) {
  for (std::int64_t i = 0; i < count; ++i) {
    worker.check_interrupt();
    const CellKey key{job_.grid.brick_level(), first + Index3{i, 0, 0}};
    const ContourParameters& parameters = edits_.around(sign_samples(job_.grid, key.at));
    build_brick(block, place_of_brick(job_.grid, key.at), parameters, scratch_, brick_);
    note(key, brick_.root, brick_.counts);
    if (brick_.root.state == NodeState::outside) continue;
    note_surface(key, brick_.root, brick_.blocks);
    if (brick_.root.state != NodeState::inside) out_->brick(morton_encode(key.at), brick_);
    if (share_ != nullptr) share_->yield();
  }
}

std::vector<ShardNode> SurfaceOctrees::reduce() {
  summary_.bricks = static_cast<std::uint64_t>(job_.grid.shard_bricks(shard_).count());
  std::sort(roots_.begin(), roots_.end(),
            [](const Root& a, const Root& b) { return a.node.key.code() < b.node.key.code(); });

  std::vector<ShardNode> nodes;
  auto root = roots_.begin();
  for (const BrickGrid::Cube& cube : job_.grid.shard_cubes(shard_)) {
    ShardNode node;
    node.key = cube.key;
    NodeCollector sink;
    sink.node = &node;
    sink.summary = &summary_;
    sink.brick_level = job_.grid.brick_level();
    OctreeReduction reduction(cube.key, job_.grid.domain_level(), job_.parameters, sink);
    for (; root != roots_.end() && cube.key.cells().contains(root->node.key.cells()); ++root) {
      reduction.push(root->node);
      if (root->node.record.state != NodeState::split) continue;
      std::uint32_t begin = 0;
      for (std::size_t b = 0; b < root->blocks.size(); ++b) {
        const BlockCount& block = root->blocks[b];
        if (block.vertices != 0 || block.polygon_end != begin)
          sink.cube({root->node.key.code() + (b << (3 * block_level)), block_level, block.vertices,
                     block.polygon_end - begin});
        begin = block.polygon_end;
      }
    }
    const NodeSummary reduced = reduction.finish();
    summary_.collapsed_above += reduction.collapsed();
    node.record = reduced.record;
    node.polygons = reduced.polygons;
    nodes.push_back(std::move(node));
  }
  return nodes;
}

}  // namespace

std::unique_ptr<ShardOctrees> make_shard_octrees(const BuildJob& job) {
  if (job.parameters.labels.mode == LabelMode::each) return std::make_unique<LabelOctrees>(job);
  return std::make_unique<SurfaceOctrees>(job);
}

}  // namespace voxweld
