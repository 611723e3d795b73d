#include "pipeline/merge/material_merge.h"

#include <algorithm>
#include <memory>
#include <optional>

#include "pipeline/executor/probe.h"
#include "pipeline/stage/batch_planner.h"
#include "stages/merge/shard_reduction.h"
#include "storage/artifact/node_record_bytes.h"
#include "storage/artifact/shard_artifact.h"
#include "storage/artifact/top_artifact.h"
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

void add_counts(const BrickCounts& part, MergeCounts& counts) {
  counts.active_cells += part.active_cells;
  counts.crossing_edges += part.crossing_edges;
  counts.vertices += part.vertices;
  add(counts.by_level, part.by_level);
}

// One material after the other, from its nodes in Morton order.
class MaterialMerger : private TopSink {
 public:
  MaterialMerger(const MergeJob& job, TopArtifactWriter& out, MergeCounts& counts)
      : job_(job),
        grid_(job.build->grid),
        by_sheets_(collapses_by_sheets(job.build->parameters)),
        out_(out),
        counts_(counts),
        batches_(out, job.tile_vertices) {}

  void open(Material material) {
    material_ = material;
    TopSink& sink = *this;
    reduction_.emplace(grid_, job_.build->parameters, job_.tile_vertices, sink);
  }

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
  void close() {
    if (!reduction_) return;
    reduction_->finish();
    counts_.collapsed_above += reduction_->collapsed();
    add_counts(reduction_->counts(), counts_);
    for (const SurfaceNode& node : nodes_) out_.node(node);
    for (const PlannedTile& tile : tiles_) out_.tile(tile);
    end_surface();
    add_batches();
    reduction_.reset();
    nodes_.clear();
    tiles_.clear();
    leaves_.clear();
    largest_piece_ = vertices_ = 0;
  }

  // A label's units are known by what merge has read of it. Stitch looks itself at what the tiles of a
  // single surface read: brick by brick, so that a change leaves most of them as they are.
  void add_batches() {
    std::optional<TileInputs> inputs;
    if (job_.build->parameters.labels.mode == LabelMode::each)
      inputs.emplace(grid_, material_, nodes_, leaves_, reduction_->reduced());
    batches_.add(material_, tiles_, largest_piece_, [&](KeyHasher& key, const PlannedTile& tile) {
      if (inputs) inputs->add_to(key, tile);
    });
  }

  void end_surface() {
    if (!by_sheets_) return out_.end_surface(material_);
    if (!reduction_->reduced().leaves.empty()) out_.clusters(reduction_->reduced());
    // Its tiles are planned by more.
    out_.end_surface(material_, vertices_ + reduction_->counts().vertices);
  }

  void leaf(const TopLeaf& leaf, bool known) override {
    ++counts_.top_leaves;
    out_.leaf(leaf);
    if (!known) leaves_.push_back(leaf);
  }
  void tile(const PlannedTile& tile) override { tiles_.push_back(tile); }

  const MergeJob& job_;
  const BrickGrid& grid_;
  const bool by_sheets_;
  TopArtifactWriter& out_;
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

std::unique_ptr<ShardArtifact> open_shard(const BuildJob& job, Index3 shard) {
  auto file = std::make_unique<ShardArtifact>(shard_artifact_path(job, shard));
  if (file->key() != shard_key(job, shard))
    throw DamagedArtifact(file->path(), "is of other parameters");
  return file;
}

void add_summary(const ShardSummary& shard, MergeCounts& counts) {
  counts.bricks += shard.bricks;
  counts.active_bricks += shard.active_bricks;
  counts.collapsed_above += shard.collapsed_above;
  add_counts(shard.counts, counts);
}

// What merge reads of one octree artifact: one cube's part of it.
struct CubeRoots {
  Hash128 content;
  ShardSummary summary;
  std::vector<MaterialNode> nodes;
};
constexpr std::size_t cubes_ahead = 128;  // up to 100 KiB each

CubeRoots read_roots(const BuildJob& job, const BrickGrid::Cube& cube) {
  const auto file = open_shard(job, cube.shard);
  CubeRoots roots{file->content_hash(), file->summary(), {}};
  for (std::uint64_t page = 0; page < file->node_pages(); ++page)
    file->each_node(page, [&](const MaterialNode& node, std::span<const std::byte>) {
      if (node.node.key == cube.key) roots.nodes.push_back(node);
    });
  return roots;
}

// The nodes of one material, in the order of the octree. A shard may have several cubes, which do
// not follow each other there. Returns the content hashes of the artifacts, in the order of build's
// units.
std::vector<Hash128> merge_cubes(const BuildJob& job, MaterialMerger& merger, MergeCounts& counts) {
  std::vector<std::uint64_t> codes;  // of the shards, ascending
  for (const Index3& shard : job.grid.all_shards()) codes.push_back(morton_encode(shard));
  std::vector<Hash128> contents(codes.size());
  std::vector<bool> seen(codes.size());
  const std::vector<BrickGrid::Cube> cubes = job.grid.all_cubes();
  merger.open(sole_material);
  probe_in_order<CubeRoots>(
      cubes.size(), cubes_ahead, [&](std::size_t i) { return read_roots(job, cubes[i]); },
      [&](std::size_t i, CubeRoots&& roots) {
        const auto found = std::ranges::lower_bound(codes, morton_encode(cubes[i].shard));
        const auto at = static_cast<std::size_t>(found - codes.begin());
        if (!seen[at]) add_summary(roots.summary, counts);
        seen[at] = true;
        contents[at] = roots.content;
        for (const MaterialNode& node : roots.nodes) merger.add(node);
      });
  return contents;
}

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
  roots.file = open_shard(job, shard);
  roots.summary = roots.file->summary();
  if (roots.file->node_pages() > 0)
    each_node(*roots.file, 0, [&](SortKey key, std::span<const std::byte> bytes) {
      roots.nodes.emplace_back(key, std::vector<std::byte>(bytes.begin(), bytes.end()));
    });
  return roots;
}

// The nodes of many materials, put in their order first. Returns as merge_cubes.
std::vector<Hash128> merge_sorted(const MergeJob& job, std::uint64_t memory, MaterialMerger& merger,
                                  MergeCounts& counts) {
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
  SortKey key;
  std::vector<std::byte> bytes;
  while (nodes.next(key, bytes)) merger.add(material_node_of(bytes));
  return contents;
}

// Where each sheet collapses by itself, once all else is counted.
void count_top_leaves(const BuildJob& job, MergeCounts& counts) {
  if (!collapses_by_sheets(job.parameters)) return;
  for (std::size_t l = static_cast<std::size_t>(job.grid.brick_level()) + 1;
       l < counts.by_level.leaves.size(); ++l)
    counts.top_leaves += counts.by_level.leaves[l];
}

}  // namespace

void merge_materials(const MergeJob& job, std::uint64_t memory) {
  TopArtifactWriter out(job.path(), job.key);
  MergeCounts counts;
  MaterialMerger merger(job, out, counts);
  const std::vector<Hash128> contents = job.build->parameters.labels.mode == LabelMode::each
                                            ? merge_sorted(job, memory, merger, counts)
                                            : merge_cubes(*job.build, merger, counts);
  merger.finish();
  count_top_leaves(*job.build, counts);
  out.finish(counts, contents);
}

}  // namespace voxweld
