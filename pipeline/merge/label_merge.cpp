#include "pipeline/merge/label_merge.h"

#include <algorithm>
#include <memory>
#include <optional>

#include "pipeline/executor/probe.h"
#include "pipeline/stage/batch_planner.h"
#include "storage/artifact/label_top.h"
#include "storage/artifact/node_record_bytes.h"
#include "storage/artifact/shard_artifact.h"
#include "storage/support/error.h"
#include "storage/support/record_sorter.h"

namespace voxweld {
namespace {

// What stitching a tile of one label reads, as a hash.
class TileInputs {
 public:
  TileInputs(const BrickGrid& grid, Material material, std::span<const SurfaceNode> nodes,
             std::span<const TopLeaf> leaves, const ReducedNode& clusters)
      : cube_level_(grid.shard_level()),
        brick_(std::int64_t{1} << grid.brick_level()),
        material_(material),
        nodes_(nodes),
        leaves_(leaves) {
    if (!clusters.leaves.empty()) put_links(clusters, clusters_);
  }

  void add_to(KeyHasher& key, const PlannedTile& tile) const {
    key.integer(static_cast<std::int64_t>(material_));
    key.integer(static_cast<std::int64_t>(tile.code)).integer(tile.level);
    if (!clusters_.empty()) key.bytes(clusters_);
    for (const SurfaceNode* node : nodes_read(tile.key())) {
      key.integer(static_cast<std::int64_t>(node->code)).hash(node->content);
      if (const TopLeaf* leaf = leaf_above(node->code))
        key.bytes(std::as_bytes(std::span(leaf, 1)));
    }
  }

 private:
  CellKey cube_of(const SurfaceNode& node) const {
    return {cube_level_, morton_decode(node.code >> (3 * cube_level_))};
  }

  // Of the cubes that the tile's bricks and their upper neighbours lie in.
  std::vector<const SurfaceNode*> nodes_read(CellKey tile) const {
    std::vector<const SurfaceNode*> found;
    const CellKey within = cube_level_ <= tile.level ? tile : cube_around(tile);
    const Box3 reached{tile.lo(), tile.cells().hi + splat(brick_)};
    const std::uint64_t begin = within.code(), end = begin + (std::uint64_t{1} << 3 * within.level);
    for (auto node = at_or_after(begin); node != nodes_.end() && node->code < end; ++node) {
      found.push_back(&*node);
      for (int d = 1; d < 8; ++d) {
        const CellKey cube = cube_of(*node);
        const CellKey upper{cube_level_, cube.at + Index3{d & 1, d >> 1 & 1, d >> 2}};
        if (within.cells().contains(upper.cells()) || intersect(upper.cells(), reached).empty())
          continue;
        const auto at = at_or_after(upper.code());
        if (at != nodes_.end() && at->code == upper.code()) found.push_back(&*at);
      }
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }
  CellKey cube_around(CellKey tile) const {
    while (tile.level < cube_level_) tile = tile.parent();
    return tile;
  }
  std::span<const SurfaceNode>::iterator at_or_after(std::uint64_t code) const {
    return std::lower_bound(nodes_.begin(), nodes_.end(), code,
                            [](const SurfaceNode& node, std::uint64_t c) { return node.code < c; });
  }
  const TopLeaf* leaf_above(std::uint64_t code) const {
    const auto after =
        std::upper_bound(leaves_.begin(), leaves_.end(), code,
                         [](std::uint64_t c, const TopLeaf& leaf) { return c < leaf.code; });
    if (after == leaves_.begin()) return nullptr;
    const TopLeaf& leaf = *(after - 1);
    return code - leaf.code < std::uint64_t{1} << (3 * leaf.level) ? &leaf : nullptr;
  }

  int cube_level_;
  std::int64_t brick_;
  Material material_;
  std::span<const SurfaceNode> nodes_;  // ascending
  std::span<const TopLeaf> leaves_;     // those no shard knows of, ascending
  std::vector<std::byte> clusters_;     // where each sheet collapses by itself, all of the label
};

// One label after the other, from its nodes in Morton order.
class LabelMerger : private TopSink {
 public:
  LabelMerger(const MergeJob& job, LabelTopWriter& out, MergeCounts& counts)
      : job_(job),
        grid_(job.build->grid),
        out_(out),
        counts_(counts),
        batches_(out, job.tile_vertices) {}

  void add(const MaterialNode& node) {
    if (!reduction_ || node.material != material_) {
      close();
      open(node.material);
    }
    reduction_->add(node.node);
    vertices_ += node.final_vertices;
    if (node.node.record.state == NodeState::inside) return;
    nodes_.push_back({node.node.key.code(), node.content});
    largest_piece_ = std::max(largest_piece_, node.largest_piece);
  }

  void finish() {
    close();
    batches_.finish();
  }

 private:
  void open(Material material) {
    material_ = material;
    TopSink& sink = *this;
    reduction_.emplace(grid_, job_.build->parameters, job_.tile_vertices, sink);
  }

  void close() {
    if (!reduction_) return;
    reduction_->finish();
    add_reduced(*reduction_, counts_);
    for (const SurfaceNode& node : nodes_) out_.node(node);
    for (const PlannedTile& tile : tiles_) out_.tile(tile);
    end_surface();
    const TileInputs inputs(grid_, material_, nodes_, leaves_, reduction_->reduced());
    batches_.add(material_, tiles_, largest_piece_,
                 [&](KeyHasher& key, const PlannedTile& tile) { inputs.add_to(key, tile); });
    reduction_.reset();
    nodes_.clear();
    tiles_.clear();
    leaves_.clear();
    largest_piece_ = 0;
  }

  void end_surface() {
    if (!collapses_by_sheets(job_.build->parameters)) return out_.end_surface(material_);
    if (!reduction_->reduced().leaves.empty()) out_.clusters(reduction_->reduced());
    // Its tiles are planned by more.
    out_.end_surface(material_, vertices_ + reduction_->counts().vertices);
    vertices_ = 0;
  }

  void leaf(const TopLeaf& leaf, bool known) override {
    ++counts_.top_leaves;
    out_.leaf(leaf);
    if (!known) leaves_.push_back(leaf);
  }
  void tile(const PlannedTile& tile) override { tiles_.push_back(tile); }

  const MergeJob& job_;
  const BrickGrid& grid_;
  LabelTopWriter& out_;
  MergeCounts& counts_;
  BatchPlanner batches_;
  Material material_ = exterior;
  std::optional<TopReduction> reduction_;
  std::vector<SurfaceNode> nodes_;
  std::vector<PlannedTile> tiles_;
  std::vector<TopLeaf> leaves_;
  std::uint64_t largest_piece_ = 0;
  std::uint64_t vertices_ = 0;  // where each sheet collapses by itself: final in the shards
};

// What is read of one shard ahead: the first of its nodes, which mostly are all.
struct ShardRoots {
  std::unique_ptr<ShardArtifact> file;
  ShardSummary summary;
  std::vector<std::pair<SortKey, std::vector<std::byte>>> nodes;
};
constexpr std::size_t shards_ahead = 32;  // of 256 KiB each, or one node

template <class F>
void each_node(const ShardArtifact& file, std::uint64_t page, F&& f) {
  file.each_node(page, [&](const MaterialNode& node, std::span<const std::byte> bytes) {
    f(SortKey{node.material, node.node.key.code()}, bytes);
  });
}

ShardRoots read_roots(const BuildJob& job, Index3 shard) {
  ShardRoots roots;
  roots.file = std::make_unique<ShardArtifact>(shard_artifact_path(job, shard));
  if (roots.file->key() != shard_key(job, shard))
    throw DamagedArtifact(roots.file->path(), "is of other parameters");
  roots.summary = roots.file->summary();
  if (roots.file->node_pages() > 0)
    each_node(*roots.file, 0, [&](SortKey key, std::span<const std::byte> bytes) {
      roots.nodes.emplace_back(key, std::vector<std::byte>(bytes.begin(), bytes.end()));
    });
  return roots;
}

}  // namespace

void merge_labels(const MergeJob& job, std::uint64_t memory) {
  MergeCounts counts;
  std::vector<Hash128> contents;
  RecordSorter nodes(job.folder, memory);
  const std::vector<Index3> shards = job.build->grid.all_shards();
  const auto push = [&](SortKey key, std::span<const std::byte> bytes) { nodes.push(key, bytes); };
  probe_in_order<ShardRoots>(
      shards.size(), shards_ahead, [&](std::size_t i) { return read_roots(*job.build, shards[i]); },
      [&](std::size_t, ShardRoots&& roots) {
        contents.push_back(roots.file->content_hash());
        add_summary(roots.summary, counts);
        for (const auto& [key, bytes] : roots.nodes) push(key, bytes);
        for (std::uint64_t page = 1; page < roots.file->node_pages(); ++page)
          each_node(*roots.file, page, push);
      });

  LabelTopWriter out(job.path(), job.key);
  LabelMerger merger(job, out, counts);
  SortKey key;
  std::vector<std::byte> bytes;
  while (nodes.next(key, bytes)) merger.add(material_node_of(bytes));
  merger.finish();
  count_top_leaves(*job.build, counts);
  out.finish(counts, contents);
}

}  // namespace voxweld
